// The MD5 sum by which ROS tells message types apart, computed from a definition.
#pragma once

#include <string>

namespace adhoc_communication {

/// Of `definition` with the definitions of all types that it uses, as publishers and bag files carry it. Throws
/// PayloadError when one of these is missing, or the types nest too deeply.
std::string md5_of_definition(const std::string& type, const std::string& definition);

}  // namespace adhoc_communication
