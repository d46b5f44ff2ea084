// Deserialisation of bytes from the air: never reads past the end, never allocates more than the bytes can hold.
#pragma once

#include <ros/serialization.h>

#include <cstring>
#include <vector>

namespace adhoc_communication {

/// The input stream of roscpp resizes a vector to whatever count the bytes claim before it looks whether they are
/// there. This one compares the claim with what is left first. Throws ros::serialization::StreamOverrunException.
class CheckedStream : public ros::serialization::Stream {
 public:
  static const ros::serialization::StreamType stream_type = ros::serialization::stream_types::Input;

  CheckedStream(const std::uint8_t* data, std::size_t size)
      : Stream(const_cast<std::uint8_t*>(data), static_cast<std::uint32_t>(size)) {}  // an input stream only reads

  template <typename T>
  void next(T& value) {
    ros::serialization::deserialize(*this, value);
  }

  template <typename T, typename Allocator>
  void next(std::vector<T, Allocator>& values) {
    check_count(ros::serialization::serializationLength(T()));
    ros::serialization::deserialize(*this, values);
  }

 private:
  void check_count(std::uint32_t smallest_element) {
    std::uint32_t count = 0;
    if (getLength() < sizeof count) ros::serialization::throwStreamOverrun();
    std::memcpy(&count, getData(), sizeof count);  // little endian, as ROS serialisation is
    if (std::uint64_t{count} * smallest_element > getLength() - sizeof count) ros::serialization::throwStreamOverrun();
  }
};

}  // namespace adhoc_communication
