#include "journal.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

namespace mr_robot::slam {
namespace {

constexpr char kScan = 'S', kLink = 'L', kPoses = 'P';
constexpr std::size_t kHeader = sizeof(char) + sizeof(std::uint32_t);  // kind, octets of the entry

class Writer {
 public:
  explicit Writer(char kind) : kind_(kind) {}

  template <class T>
  Writer& operator<<(const T& value) {
    return put(&value, 1);
  }
  template <class T>
  Writer& put(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    octets_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    return *this;
  }
  void append_to(std::string* written) const {
    const auto size = static_cast<std::uint32_t>(octets_.size());
    written->push_back(kind_);
    written->append(reinterpret_cast<const char*>(&size), sizeof(size));
    written->append(octets_);
  }

 private:
  char kind_;
  std::string octets_;
};

class Reader {
 public:
  explicit Reader(std::string_view octets) : octets_(octets) {}

  template <class T>
  T get() {
    T value{};
    get(&value, 1);
    return value;
  }
  template <class T>
  void get(T* values, std::size_t count) {
    whole_ = whole_ && octets_.size() >= count * sizeof(T);
    if (!whole_) return;
    std::memcpy(values, octets_.data(), count * sizeof(T));
    octets_.remove_prefix(count * sizeof(T));
  }
  // As many as there are.
  template <class T>
  std::vector<T> rest() {
    std::vector<T> values(octets_.size() / sizeof(T));
    get(values.data(), values.size());
    return values;
  }
  bool read_to_the_end() const { return whole_ && octets_.empty(); }

 private:
  std::string_view octets_;
  bool whole_ = true;
};

constexpr double kFarthest = 1e4;   // m that a robot is from where its map begins
constexpr double kLongRange = 1e3;  // m that a laser sees

bool sound(const Pose& pose) {
  return std::abs(pose.x) < kFarthest && std::abs(pose.y) < kFarthest && std::isfinite(pose.yaw);
}

bool sound(const LaserGeometry& geometry) {
  return std::isfinite(geometry.angle_min) && std::isfinite(geometry.angle_increment) &&
         std::isfinite(geometry.range_min) && geometry.range_max > 0.0 && geometry.range_max < kLongRange &&
         sound(geometry.mount) && sound(geometry.swept);
}

std::optional<JournalEntry> scan_of(Reader* reader) {
  JournalScan scan{};
  scan.opens = reader->get<std::uint8_t>() != 0;
  scan.pose = reader->get<Pose>();
  scan.odometry = reader->get<Pose>();
  scan.way = reader->get<Way>();
  scan.geometry = reader->get<LaserGeometry>();
  scan.ranges = reader->rest<float>();
  const bool good = sound(scan.pose) && sound(scan.odometry) && sound(scan.geometry) && !scan.ranges.empty() &&
                    std::isfinite(scan.way.distance) && std::isfinite(scan.way.turn);
  return good ? std::optional<JournalEntry>(std::move(scan)) : std::nullopt;
}

std::optional<JournalEntry> link_of(Reader* reader) {
  JournalLink link{};
  link.from = reader->get<std::uint32_t>();
  link.to = reader->get<std::uint32_t>();
  link.relative = reader->get<Pose>();
  reader->get(link.information.data(), 9);
  link.sure = reader->get<std::uint8_t>() != 0;
  const bool good =
      sound(link.relative) && link.information.allFinite() && link.information.llt().info() == Eigen::Success;
  return good ? std::optional<JournalEntry>(link) : std::nullopt;
}

std::optional<JournalEntry> poses_of(Reader* reader) {
  JournalPoses poses{};
  poses.closing = reader->get<std::uint8_t>() != 0;
  poses.poses = reader->rest<Pose>();
  for (const Pose& pose : poses.poses) {
    if (!sound(pose)) return std::nullopt;
  }
  return poses;
}

std::optional<JournalEntry> entry_of(char kind, std::string_view octets) {
  Reader reader(octets);
  std::optional<JournalEntry> entry;
  if (kind == kScan) entry = scan_of(&reader);
  if (kind == kLink) entry = link_of(&reader);
  if (kind == kPoses) entry = poses_of(&reader);
  return reader.read_to_the_end() ? entry : std::nullopt;
}

}  // namespace

void Journal::write(const JournalScan& scan) {
  if (!kept_) return;
  Writer entry(kScan);
  entry << static_cast<std::uint8_t>(scan.opens) << scan.pose << scan.odometry << scan.way << scan.geometry;
  entry.put(scan.ranges.data(), scan.ranges.size()).append_to(&written_);
}

void Journal::write(const JournalLink& link) {
  if (!kept_) return;
  Writer entry(kLink);
  entry << static_cast<std::uint32_t>(link.from) << static_cast<std::uint32_t>(link.to) << link.relative;
  entry.put(link.information.data(), 9) << static_cast<std::uint8_t>(link.sure);
  entry.append_to(&written_);
}

void Journal::write(const JournalPoses& poses) {
  if (!kept_) return;
  Writer entry(kPoses);
  entry << static_cast<std::uint8_t>(poses.closing);
  entry.put(poses.poses.data(), poses.poses.size()).append_to(&written_);
}

std::string Journal::take() { return std::exchange(written_, {}); }

std::vector<JournalEntry> entries_of(std::string_view written, std::size_t* used) {
  std::vector<JournalEntry> entries;
  for (*used = 0; written.size() - *used >= kHeader;) {
    std::uint32_t size = 0;
    std::memcpy(&size, written.data() + *used + 1, sizeof(size));
    if (size > written.size() - *used - kHeader) break;
    auto entry = entry_of(written[*used], written.substr(*used + kHeader, size));
    if (!entry) break;
    entries.push_back(std::move(*entry));
    *used += kHeader + size;
  }
  return entries;
}

}  // namespace mr_robot::slam
