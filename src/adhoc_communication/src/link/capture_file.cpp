#include "link/capture_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <utility>

#include "link/ethernet.hpp"
#include "run_guarded.hpp"

namespace adhoc_communication {
namespace {

constexpr std::uint32_t kMagicNanoseconds = 0xa1b23c4d;
constexpr std::uint64_t kFileHeaderSize = 24;
constexpr std::uint64_t kRecordHeaderSize = 16;
constexpr std::uint32_t kLargestRecord = 262144;
constexpr std::uint32_t kEthernet = 1;  // LINKTYPE_ETHERNET

/// In the byte order of the host, which readers tell from the magic number.
template <typename Value>
void put(Bytes& octets, Value value) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
  octets.insert(octets.end(), first, first + sizeof value);
}

Bytes file_header() {
  Bytes octets;
  put(octets, kMagicNanoseconds);
  put(octets, std::uint16_t{2});
  put(octets, std::uint16_t{4});
  put(octets, std::uint32_t{0});
  put(octets, std::uint32_t{0});
  put(octets, kLargestRecord);
  put(octets, kEthernet);
  return octets;
}

}  // namespace

CaptureFile::CaptureFile(std::string path, std::uint64_t most_octets)
    : path_(std::move(path)),
      most_in_file_(most_octets == 0 ? std::numeric_limits<std::uint64_t>::max() : most_octets / 2) {
  keep_former();
  if (!begin_file() && errno != ENOSPC && errno != EDQUOT) {
    throw std::invalid_argument("parameter ~capture_file = " + path_ +
                                " names no file that can be written: " + std::strerror(errno));
  }
  thread_ = std::thread([this] { run(); });
}

CaptureFile::~CaptureFile() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  thread_.join();
}

void CaptureFile::add(const Frame& frame, std::chrono::nanoseconds at) {
  const Bytes octets = to_wire(frame);
  const std::uint64_t room = std::min(kMostBuffered, most_in_file_ - kFileHeaderSize);  // a batch fits an empty file
  const std::lock_guard<std::mutex> lock(mutex_);
  if (ended_ || waiting_.octets.size() + kRecordHeaderSize + octets.size() > room) {
    ++lost_;
    return;
  }
  put(waiting_.octets, static_cast<std::uint32_t>(at.count() / 1'000'000'000));
  put(waiting_.octets, static_cast<std::uint32_t>(at.count() % 1'000'000'000));
  put(waiting_.octets, static_cast<std::uint32_t>(octets.size()));
  put(waiting_.octets, static_cast<std::uint32_t>(octets.size()));
  waiting_.octets.insert(waiting_.octets.end(), octets.begin(), octets.end());
  ++waiting_.frames;
  arrived_.notify_one();
}

void CaptureFile::run() {
  run_guarded(
      "capturing to " + path_, [this] { work(); },
      [this](const std::string& text) {
        std::fprintf(stderr, "%s\n", text.c_str());
        const std::lock_guard<std::mutex> lock(mutex_);
        ended_ = true;
      });
}

void CaptureFile::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    arrived_.wait(lock, [this] { return stopping_ || waiting_.frames > 0; });
    const Batch batch = std::exchange(waiting_, {});
    const bool ends = stopping_;
    lock.unlock();
    if (batch.frames > 0) write(batch);
    if (ends) return;
    lock.lock();
  }
}

void CaptureFile::write(const Batch& batch) {
  if (size_ + batch.octets.size() > most_in_file_) {
    file_.reset();
    keep_as_old();
  }
  const bool written = (file_.is_open() || begin_file()) && append(batch.octets);
  (written ? written_ : lost_) += batch.frames;
}

/// That of a node that has crashed and was started again tells why.
void CaptureFile::keep_former() const {
  std::error_code error;
  if (std::filesystem::symlink_status(path_, error).type() != std::filesystem::file_type::regular) return;
  if (std::filesystem::file_size(path_, error) <= most_in_file_) keep_as_old();
}

void CaptureFile::keep_as_old() const { std::rename(path_.c_str(), (path_ + ".old").c_str()); }

bool CaptureFile::begin_file() {
  file_.reset();
  size_ = 0;
  FileDescriptor file(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!file.is_open()) return false;
  file_ = std::move(file);
  if (append(file_header())) return true;
  const int reason = errno;
  file_.reset();
  errno = reason;
  return false;
}

/// All of it or nothing, so that the file stays readable up to its end.
bool CaptureFile::append(const Bytes& octets) {
  std::size_t done = 0;
  while (done < octets.size()) {
    const ssize_t written = ::write(file_.get(), octets.data() + done, octets.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      if (ftruncate(file_.get(), static_cast<off_t>(size_)) == 0) {
        lseek(file_.get(), static_cast<off_t>(size_), SEEK_SET);
      }
      errno = reason;
      return false;
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += octets.size();
  return true;
}

}  // namespace adhoc_communication
