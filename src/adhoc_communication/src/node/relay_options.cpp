#include "node/relay_options.hpp"

#include <xmlrpcpp/XmlRpcValue.h>

#include <stdexcept>

namespace adhoc_communication {
namespace {

using XmlRpc::XmlRpcValue;

std::string text_field(XmlRpcValue& value, const std::string& name) {
  if (value.getType() != XmlRpcValue::TypeString)
    throw std::invalid_argument("has a " + name + " that is not a string");
  return static_cast<std::string>(value);
}

double number_field(XmlRpcValue& value, const std::string& name) {
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(value);
  if (value.getType() != XmlRpcValue::TypeDouble) {
    throw std::invalid_argument("has a " + name + " that is not a number");
  }
  return static_cast<double>(value);
}

bool flag_field(XmlRpcValue& value, const std::string& name) {
  if (value.getType() != XmlRpcValue::TypeBoolean) {
    throw std::invalid_argument("has a " + name + " that is not true or false");
  }
  return static_cast<bool>(value);
}

void set_field(RelayEntry& entry, const std::string& name, XmlRpcValue& value) {
  if (name == "topic") {
    entry.topic = text_field(value, name);
  } else if (name == "destination") {
    entry.destination = text_field(value, name);
  } else if (name == "remote_topic") {
    entry.remote_topic = text_field(value, name);
  } else if (name == "priority") {
    entry.priority = parse_priority(text_field(value, name));
  } else if (name == "rate") {
    entry.rate = number_field(value, name);
  } else if (name == "latched") {
    entry.latched = flag_field(value, name);
  } else if (name == "lifetime") {
    entry.lifetime = number_field(value, name);
  } else if (name == "newest_only") {
    entry.newest_only = flag_field(value, name);
  } else {
    throw std::invalid_argument(
        "has the unknown field '" + name +
        "' (known: topic, destination, remote_topic, priority, rate, latched, lifetime, newest_only)");
  }
}

RelayEntry parse_relay(XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeStruct || !value.hasMember("topic") || !value.hasMember("destination")) {
    throw std::invalid_argument("has an element that is not a struct with topic and destination");
  }
  RelayEntry entry;
  for (auto& [name, field] : value) set_field(entry, name, field);
  check_topics(entry);
  return entry;
}

}  // namespace

std::vector<RelayEntry> parse_relays(const XmlRpcValue& value) {
  XmlRpcValue list(value);  // XmlRpcValue has no const iteration
  if (list.getType() != XmlRpcValue::TypeArray) throw std::invalid_argument("is not a list");
  std::vector<RelayEntry> entries;
  for (int i = 0; i < list.size(); ++i) entries.push_back(parse_relay(list[i]));
  return entries;
}

}  // namespace adhoc_communication
