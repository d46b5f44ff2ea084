#include "separate_engine.hpp"

#include <sys/socket.h>
#include <sys/wait.h>

#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace adhoc_communication::bench {
namespace {

constexpr std::uint64_t kTurnsPerMeasurement = 256;

/// Fixed fields in front of the frames of a message.
struct Head {
  Time time{0};
  std::size_t resident = 0;
  std::size_t peak = 0;
  std::size_t frames = 0;
};

void write_all(int socket, const void* octets, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t part = send(socket, static_cast<const char*>(octets) + done, size - done, MSG_NOSIGNAL);
    if (part <= 0) throw std::runtime_error("the process of the engine has ended");
    done += static_cast<std::size_t>(part);
  }
}

bool read_all(int socket, void* octets, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t part = recv(socket, static_cast<char*>(octets) + done, size - done, 0);
    if (part <= 0) return false;
    done += static_cast<std::size_t>(part);
  }
  return true;
}

void write_message(int socket, const Head& head, const std::vector<Frame>& frames) {
  Bytes message(sizeof head);
  std::memcpy(message.data(), &head, sizeof head);
  for (const Frame& frame : frames) {
    message.insert(message.end(), frame.destination.begin(), frame.destination.end());
    message.insert(message.end(), frame.source.begin(), frame.source.end());
    message.push_back(static_cast<std::uint8_t>(frame.bytes.size() >> 8));
    message.push_back(static_cast<std::uint8_t>(frame.bytes.size()));
    message.insert(message.end(), frame.bytes.begin(), frame.bytes.end());
  }
  write_all(socket, message.data(), message.size());
}

bool read_message(int socket, Head& head, std::vector<Frame>& frames) {
  if (!read_all(socket, &head, sizeof head)) return false;
  frames.resize(head.frames);
  for (Frame& frame : frames) {
    std::uint8_t size[2];
    if (!read_all(socket, frame.destination.data(), 6) || !read_all(socket, frame.source.data(), 6)) return false;
    if (!read_all(socket, size, sizeof size)) return false;
    frame.bytes.resize(std::size_t{size[0]} << 8 | size[1]);
    if (!read_all(socket, frame.bytes.data(), frame.bytes.size())) return false;
  }
  return true;
}

/// In kB.
struct Memory {
  std::size_t resident = 0;
  std::size_t peak = 0;
};

Memory memory_of_this_process() {
  Memory memory;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") status >> memory.resident;
    if (word == "VmHWM:") status >> memory.peak;
  }
  return memory;
}

void serve(Engine& engine, int socket) {
  Head head;
  Memory memory;
  std::vector<Frame> frames;
  for (std::uint64_t turn = 0; read_message(socket, head, frames); ++turn) {
    const Time now = head.time;
    for (const Frame& frame : frames) engine.receive(frame, now);
    frames = engine.poll(now);
    while (engine.next_event()) continue;
    if (turn % kTurnsPerMeasurement == 0) memory = memory_of_this_process();
    write_message(socket, {engine.next_deadline(), memory.resident, memory.peak, frames.size()}, frames);
  }
}

}  // namespace

SeparateEngine::SeparateEngine(const EngineOptions& options, const MacAddress& address, Time now) {
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, sockets) != 0) throw std::runtime_error("no pair of sockets");
  process_ = fork();
  if (process_ < 0) throw std::runtime_error("no further process");
  socket_ = FileDescriptor(sockets[process_ == 0 ? 1 : 0]);
  FileDescriptor other(sockets[process_ == 0 ? 0 : 1]);
  if (process_ != 0) return;
  other.reset();
  Engine engine(options, address, BootId{1}, 1, now);
  serve(engine, socket_.get());
  _exit(0);
}

SeparateEngine::~SeparateEngine() {
  socket_.reset();
  waitpid(process_, nullptr, 0);
}

SeparateEngine::Answer SeparateEngine::step(const std::vector<Frame>& frames, Time now) {
  write_message(socket_.get(), {now, 0, 0, frames.size()}, frames);
  Head head;
  Answer answer;
  if (!read_message(socket_.get(), head, answer.frames))
    throw std::runtime_error("the process of the engine has ended");
  answer.next_deadline = head.time;
  answer.resident = head.resident;
  answer.peak = head.peak;
  return answer;
}

}  // namespace adhoc_communication::bench
