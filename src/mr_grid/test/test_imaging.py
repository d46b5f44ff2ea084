"""What is taken from OpenCV is what cv2 gives."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from mr_grid import imaging

SHAPES = array_shapes(min_dims=2, max_dims=2, max_side=40)
masks = arrays(bool, SHAPES)
images = arrays(np.float32, SHAPES, elements=st.floats(0.0, 100.0, width=32))
SQUARE = np.ones((3, 3), np.uint8)


@given(masks)
def test_parts(mask):
    count, labels, statistics, middles = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
    found = imaging.parts_of(mask)
    assert len(found.areas) == count
    assert np.array_equal(found.labels, labels)
    assert np.array_equal(np.column_stack([found.boxes, found.areas]), statistics)
    assert np.array_equal(found.middles, middles, equal_nan=True)
    assert np.array_equal(found.extents(), statistics[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max(axis=1))


@given(masks)
def test_labels_of_parts(mask):
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=8)
    found, found_labels = imaging.part_labels(mask)
    assert found == count and np.array_equal(found_labels, labels)


@given(masks)
def test_masks_grow_and_shrink(mask):
    octets = mask.view(np.uint8)
    assert np.array_equal(imaging.dilated(mask, 3), cv2.dilate(octets, SQUARE).view(bool))
    cross = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    assert np.array_equal(imaging.eroded(mask, cross), cv2.erode(octets, cross).view(bool))


@given(images)
def test_images(image):
    assert np.array_equal(imaging.dilated(image, 5), cv2.dilate(image, np.ones((5, 5), np.uint8)))
    assert np.array_equal(imaging.blurred(image, 1.0), cv2.GaussianBlur(image, (0, 0), 1.0))
    assert np.array_equal(imaging.box_means(image, 3), cv2.blur(image, (3, 3)))


@given(masks.filter(np.any))
def test_nearest_cell_that_is_set(mask):
    closed = (~mask).view(np.uint8)
    labels = cv2.distanceTransformWithLabels(closed, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)[1]
    assert np.array_equal(imaging.nearest_set(mask), labels)


@given(masks.filter(np.any), st.floats(0.5, 5.0))
def test_contours(mask, tolerance):
    contours, _ = cv2.findContours(mask.view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    contour = max(contours, key=cv2.contourArea)
    found = imaging.largest_contour(mask)
    assert np.array_equal(found, contour.reshape(-1, 2))
    assert np.array_equal(
        imaging.simplified(found, tolerance), cv2.approxPolyDP(contour, tolerance, True).reshape(-1, 2)
    )


def test_circle():
    image, wanted = np.zeros((20, 30), np.uint8), np.zeros((20, 30), np.uint8)
    imaging.draw_circle(image, 12, 8, 5, 128)
    cv2.circle(wanted, (12, 8), 5, 128, 1)
    assert np.array_equal(image, wanted)


def test_windows_of_a_larger_mask():
    mask = np.zeros((10, 10), bool)
    mask[2:5, 3:5] = True
    found = imaging.parts_of(mask[1:8, 2:9])
    assert found.boxes[1].tolist() == [1, 1, 2, 3] and found.areas[1] == 6
    assert imaging.dilated(mask[1:8, 2:9], 3)[:5, :4].all() and not imaging.dilated(mask[1:8, 2:9], 3)[5:].any()


@pytest.mark.parametrize("mask", [np.zeros((0, 4), bool), np.zeros(4, bool)])
def test_arrays_that_are_none(mask):
    with pytest.raises(ValueError, match="shape"):
        imaging.parts_of(mask)


def test_no_contour():
    with pytest.raises(ValueError, match="no cell"):
        imaging.largest_contour(np.zeros((3, 3), bool))
