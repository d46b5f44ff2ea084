// The file that holds the secret of the team.
#pragma once

#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Keys as 64 hexadecimal digits, one a line; the first one seals. Empty lines and those that start with '#' are
/// skipped. Throws std::invalid_argument that names the file and what to do, also when others than the owner may read
/// it.
/// Whoever has them wipes them; no other copy stays in memory.
std::vector<TeamKey> read_key_file(const std::string& path);

/// Sees when a file was changed or replaced.
class FileWatch {
 public:
  explicit FileWatch(std::string path);
  /// True once for each change.
  bool changed();

 private:
  std::string state() const;

  std::string path_;
  std::string last_;
};

}  // namespace adhoc_communication
