#include <signal.h>
#include <sys/signalfd.h>

#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "radio/options.hpp"
#include "radio/radio.hpp"

namespace {

using adhoc_communication::Radio;
using adhoc_communication::RadioOptions;

/// SIGINT and SIGTERM as something to wait for. Blocked before anything else, so that an early one is not lost.
adhoc_communication::FileDescriptor termination_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  return adhoc_communication::FileDescriptor(signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
}

void write_statistics(const std::string& path, const Radio& radio) {
  if (path.empty()) return;
  std::ofstream file(path);
  file << radio.statistics();
  if (!file.flush()) throw std::runtime_error("cannot write statistics to " + path);
}

void run(const RadioOptions& options) {
  const auto signals = termination_signals();
  Radio radio(options);
  std::cout << "radio ready: " << options.interfaces.size() << " interfaces"
            << (options.hub.empty() ? "" : ", hub " + options.hub)
            << (options.control.empty() ? "" : ", control " + options.control) << std::endl;
  radio.run(signals.get());
  write_statistics(options.statistics, radio);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const RadioOptions options = adhoc_communication::parse_radio_options(argc, argv);
    if (options.help) {
      std::cout << adhoc_communication::kRadioUsage;
      return 0;
    }
    run(options);
  } catch (const std::invalid_argument& error) {
    std::cerr << "radio: " << error.what() << "\n(radio --help lists the options)\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "radio: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
