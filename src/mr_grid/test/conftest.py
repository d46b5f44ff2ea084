"""Keeps hypothesis repeatable."""

import cv2
from hypothesis import settings

cv2.setNumThreads(1)
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")
