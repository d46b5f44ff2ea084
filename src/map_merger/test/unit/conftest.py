"""Makes the helpers importable and keeps hypothesis repeatable."""

import os
import sys

import cv2
from hypothesis import settings

sys.path.insert(0, os.path.dirname(__file__))
cv2.setNumThreads(1)
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")
