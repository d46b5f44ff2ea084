// Python module mr_grid._imaging: functions of OpenCV's imgproc for numpy arrays, what a grid shows of robots, and of
// points.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "robot_traces.hpp"

namespace py = pybind11;

namespace {

template <typename Value>
using Array = py::array_t<Value, py::array::c_style | py::array::forcecast>;

template <typename Value>
struct CvType : cv::DataType<Value> {};
template <>
struct CvType<bool> : cv::DataType<std::uint8_t> {};

void require(bool condition, const char* text) {
  if (!condition) throw std::invalid_argument(text);
}

using Pair = std::pair<double, double>;  // x, y in m

mr_grid::Point to_point(const Pair& place) { return {place.first, place.second}; }

void require_image(const py::array& array) {
  require(array.ndim() == 2 && array.size() > 0, "an array of shape (rows, columns) that is not empty is needed");
}

// The same memory; OpenCV only reads from the matrix of what Python has given.
template <typename Value>
cv::Mat view(const Array<Value>& array) {
  require_image(array);
  return cv::Mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), CvType<Value>::type,
                 const_cast<Value*>(array.data()));
}

template <typename Value>
Array<Value> like(const py::array& other) {
  require_image(other);
  return Array<Value>({other.shape(0), other.shape(1)});
}

template <typename Value>
Array<Value> copy_of(const cv::Mat_<Value>& matrix) {
  Array<Value> array({matrix.rows, matrix.cols});
  std::copy(matrix.begin(), matrix.end(), array.mutable_data());
  return array;
}

template <typename Function>
void unlocked(Function function) {
  py::gil_scoped_release release;
  function();
}

py::tuple part_labels(const Array<bool>& mask) {
  Array<std::int32_t> labels = like<std::int32_t>(mask);
  cv::Mat from = view(mask), to = view(labels);
  int count = 0;
  unlocked([&] { count = cv::connectedComponents(from, to, 8, CV_32S); });
  return py::make_tuple(count, labels);
}

py::tuple parts(const Array<bool>& mask) {
  Array<std::int32_t> labels = like<std::int32_t>(mask);
  cv::Mat from = view(mask), to = view(labels);
  cv::Mat_<std::int32_t> statistics;
  cv::Mat_<double> middles;
  unlocked([&] { cv::connectedComponentsWithStats(from, to, statistics, middles, 8, CV_32S); });
  return py::make_tuple(labels, copy_of(statistics), copy_of(middles));
}

template <typename Value>
Array<Value> dilated(const Array<Value>& image, int side) {
  Array<Value> result = like<Value>(image);
  cv::Mat from = view(image), to = view(result);
  const cv::Mat square(side, side, CV_8U, cv::Scalar(1));
  unlocked([&] { cv::dilate(from, to, square); });
  return result;
}

Array<bool> eroded(const Array<bool>& mask, const Array<std::uint8_t>& shape) {
  Array<bool> result = like<bool>(mask);
  cv::Mat from = view(mask), to = view(result), kernel = view(shape);
  unlocked([&] { cv::erode(from, to, kernel); });
  return result;
}

Array<float> blurred(const Array<float>& image, double sigma) {
  Array<float> result = like<float>(image);
  cv::Mat from = view(image), to = view(result);
  unlocked([&] { cv::GaussianBlur(from, to, cv::Size(0, 0), sigma); });
  return result;
}

Array<float> box_means(const Array<float>& image, int side) {
  Array<float> result = like<float>(image);
  cv::Mat from = view(image), to = view(result);
  unlocked([&] { cv::blur(from, to, cv::Size(side, side)); });
  return result;
}

Array<std::int32_t> nearest_zero(const Array<bool>& mask) {
  Array<std::int32_t> labels = like<std::int32_t>(mask);
  cv::Mat from = view(mask), to = view(labels), distances;
  unlocked([&] { cv::distanceTransform(from, distances, to, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL); });
  return labels;
}

Array<std::int32_t> array_of(const std::vector<cv::Point>& points) {
  Array<std::int32_t> array({static_cast<py::ssize_t>(points.size()), static_cast<py::ssize_t>(2)});
  auto cells = array.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    cells(i, 0) = points[i].x;
    cells(i, 1) = points[i].y;
  }
  return array;
}

Array<std::int32_t> largest_contour(const Array<bool>& mask) {
  cv::Mat from = view(mask);
  std::vector<std::vector<cv::Point>> contours;
  unlocked([&] { cv::findContours(from, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE); });
  require(!contours.empty(), "no cell of the mask is set");
  const auto largest = std::max_element(contours.begin(), contours.end(), [](const auto& one, const auto& other) {
    return cv::contourArea(one) < cv::contourArea(other);
  });
  return array_of(*largest);
}

Array<std::int32_t> simplified(const Array<std::int32_t>& contour, double tolerance) {
  require(contour.ndim() == 2 && contour.shape(0) > 0 && contour.shape(1) == 2, "a contour needs the shape (n, 2)");
  const auto cells = contour.unchecked<2>();
  std::vector<cv::Point> points, kept;
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) points.emplace_back(cells(i, 0), cells(i, 1));
  cv::approxPolyDP(points, kept, tolerance, true);
  return array_of(kept);
}

void draw_circle(py::array_t<std::uint8_t, py::array::c_style> image, int column, int row, int radius, int grey) {
  require_image(image);
  cv::Mat onto(static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)), CV_8U, image.mutable_data());
  cv::circle(onto, {column, row}, radius, grey, 1);
}

mr_grid::Grid<std::int8_t> to_grid(const Array<std::int8_t>& cells, double resolution, const Pair& origin) {
  return {
      {cells.data(), static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1))}, resolution, to_point(origin)};
}

py::array_t<std::int64_t> robot_traces(const Array<std::int8_t>& cells, int occupied_from, double resolution,
                                       const Pair& origin, const std::vector<Pair>& places, double most_apart,
                                       double largest) {
  require(cells.ndim() == 2, "cells of shape (rows, columns) are needed");
  const mr_grid::OccupancyGrid grid{to_grid(cells, resolution, origin), occupied_from};
  std::vector<mr_grid::Point> points(places.size());
  std::transform(places.begin(), places.end(), points.begin(), to_point);
  const std::vector<mr_grid::Cell> found = mr_grid::robot_traces(grid, points, most_apart, largest);
  py::array_t<std::int64_t> result({static_cast<py::ssize_t>(found.size()), py::ssize_t{2}});
  auto at = result.mutable_unchecked<2>();
  for (std::size_t i = 0; i < found.size(); ++i) {
    at(i, 0) = found[i].row;
    at(i, 1) = found[i].column;
  }
  return result;
}

// One pass over the points: with numpy it takes a dozen, each through all of the memory.
py::array_t<std::int8_t> values_at(const Array<std::int8_t>& cells, double resolution, const Pair& origin,
                                   const Array<double>& points, std::int8_t outside) {
  require(cells.ndim() == 2, "cells of shape (rows, columns) are needed");
  require(points.ndim() == 2 && points.shape(1) == 2, "points of shape (n, 2) are needed");
  const auto grid = to_grid(cells, resolution, origin);
  py::array_t<std::int8_t> values(points.shape(0));
  std::int8_t* value = values.mutable_data();
  const double* point = points.data();
  for (const double* end = point + points.size(); point != end; point += 2, ++value) {
    const auto index = grid.index_of({point[0], point[1]});
    *value = index ? grid.values[*index] : outside;
  }
  return values;
}

}  // namespace

PYBIND11_MODULE(_imaging, module) {
  module.def("values_at", &values_at, py::arg("cells"), py::arg("resolution"), py::arg("origin"), py::arg("points"),
             py::arg("outside"));
  module.def("robot_traces", &robot_traces, py::arg("cells"), py::arg("occupied_from"), py::arg("resolution"),
             py::arg("origin"), py::arg("places"), py::arg("most_apart"), py::arg("largest"));
  module.attr("OPENCV_VERSION") = CV_VERSION;
  module.def("use_threads", &cv::setNumThreads, py::arg("count"));
  module.def("parts", &parts, py::arg("mask"));
  module.def("part_labels", &part_labels, py::arg("mask"));
  module.def("dilated", &dilated<bool>, py::arg("mask").noconvert(), py::arg("side"));
  module.def("dilated", &dilated<float>, py::arg("image").noconvert(), py::arg("side"));
  module.def("eroded", &eroded, py::arg("mask"), py::arg("shape"));
  module.def("blurred", &blurred, py::arg("image"), py::arg("sigma"));
  module.def("box_means", &box_means, py::arg("image"), py::arg("side"));
  module.def("nearest_zero", &nearest_zero, py::arg("mask"));
  module.def("largest_contour", &largest_contour, py::arg("mask"));
  module.def("simplified", &simplified, py::arg("contour"), py::arg("tolerance"));
  module.def("draw_circle", &draw_circle, py::arg("image").noconvert(), py::arg("column"), py::arg("row"),
             py::arg("radius"), py::arg("grey"));
}
