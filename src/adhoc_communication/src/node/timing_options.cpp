#include "node/timing_options.hpp"

#include <map>
#include <stdexcept>
#include <string>

namespace adhoc_communication {
namespace {

using XmlRpc::XmlRpcValue;

const std::map<std::string, Time Timings::*> kTimes = {
    {"active_route_timeout", &Timings::active_route_timeout}, {"node_traversal_time", &Timings::node_traversal_time},
    {"route_request_wait", &Timings::route_request_wait},     {"delete_period", &Timings::delete_period},
    {"shortest_memory", &Timings::shortest_memory},
};

const std::map<std::string, int Timings::*> kNumbers = {
    {"allowed_hello_loss", &Timings::allowed_hello_loss}, {"request_retries", &Timings::request_retries},
    {"request_rate_limit", &Timings::request_rate_limit}, {"error_rate_limit", &Timings::error_rate_limit},
    {"timeout_buffer", &Timings::timeout_buffer},         {"net_diameter", &Timings::net_diameter},
    {"ttl_threshold", &Timings::ttl_threshold},           {"local_add_ttl", &Timings::local_add_ttl},
};

const std::map<std::string, bool Timings::*> kFlags = {{"destination_only", &Timings::destination_only},
                                                       {"directed_requests", &Timings::directed_requests}};

Timings preset(XmlRpcValue value) {
  if (value.getType() != XmlRpcValue::TypeString) throw std::invalid_argument("has a preset that is not a string");
  const std::string name = static_cast<std::string>(value);
  if (name == "robots") return robot_timings();
  if (name == "rfc3561") return rfc3561_timings();
  throw std::invalid_argument("has the preset '" + name + "', not robots or rfc3561");
}

int number(const std::string& name, XmlRpcValue value) {
  if (value.getType() != XmlRpcValue::TypeInt) throw std::invalid_argument("has a " + name + " that is not an integer");
  return static_cast<int>(value);
}

bool flag(const std::string& name, XmlRpcValue value) {
  if (value.getType() != XmlRpcValue::TypeBoolean) throw std::invalid_argument("has a " + name + " that is not a bool");
  return static_cast<bool>(value);
}

}  // namespace

Timings parse_timings(const XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeString) return preset(value);
  if (value.getType() != XmlRpcValue::TypeStruct) throw std::invalid_argument("is neither a preset nor a struct");
  XmlRpcValue members(value);  // XmlRpcValue has no const access to members
  Timings timings = members.hasMember("preset") ? preset(members["preset"]) : robot_timings();
  for (auto& [name, member] : members) {
    if (name == "preset") continue;
    if (const auto time = kTimes.find(name); time != kTimes.end()) {
      timings.*(time->second) = std::chrono::milliseconds(number(name, member));
    } else if (const auto count = kNumbers.find(name); count != kNumbers.end()) {
      timings.*(count->second) = number(name, member);
    } else if (const auto choice = kFlags.find(name); choice != kFlags.end()) {
      timings.*(choice->second) = flag(name, member);
    } else {
      throw std::invalid_argument("has the unknown member '" + name + "'");
    }
  }
  return timings;
}

}  // namespace adhoc_communication
