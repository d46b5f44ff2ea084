#include "link/master_interface.hpp"

#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "link/file_descriptor.hpp"

namespace adhoc_communication {
namespace {

/// Calls `take` with the type, the beginning and the length of each attribute.
template <typename Take>
void for_each_attribute(const void* first, std::size_t size, const Take& take) {
  int left = static_cast<int>(size);
  for (const auto* attribute = static_cast<const rtattr*>(first); RTA_OK(attribute, left);
       attribute = RTA_NEXT(attribute, left)) {
    take(attribute->rta_type & NLA_TYPE_MASK, RTA_DATA(attribute), RTA_PAYLOAD(attribute));
  }
}

std::string text_of(const void* text, std::size_t size) {
  const auto* first = static_cast<const char*>(text);
  return {first, strnlen(first, size)};
}

/// What the kernel tells of an interface: the answer to RTM_GETLINK. /sys shows those of another network namespace,
/// where that was entered without mounting it anew.
std::size_t ask_for_link(const std::string& interface, void* answer, std::size_t room) {
  struct {
    nlmsghdr header;
    ifinfomsg link;
  } question{};
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = RTM_GETLINK;
  question.header.nlmsg_flags = NLM_F_REQUEST;
  question.link.ifi_index = static_cast<int>(if_nametoindex(interface.c_str()));
  const FileDescriptor kernel(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (send(kernel.get(), &question, sizeof question, 0) < 0) return 0;
  const ssize_t size = recv(kernel.get(), answer, room, MSG_DONTWAIT);  // it answers before send() ends
  return static_cast<std::size_t>(std::max<ssize_t>(size, 0));
}

std::string name_of(const void* index, std::size_t size) {
  unsigned number = 0;
  std::array<char, IF_NAMESIZE> name{};
  if (size != sizeof number) return {};
  std::memcpy(&number, index, sizeof number);
  return if_indextoname(number, name.data()) != nullptr ? name.data() : "";
}

std::string kind_in(const void* information, std::size_t size) {
  std::string kind;
  for_each_attribute(information, size, [&kind](int type, const void* data, std::size_t length) {
    if (type == IFLA_INFO_SLAVE_KIND) kind = text_of(data, length);
  });
  return kind;
}

}  // namespace

MasterInterface master_of(const std::string& interface) {
  MasterInterface master;
  constexpr std::size_t kHead = NLMSG_LENGTH(sizeof(ifinfomsg));
  alignas(nlmsghdr) std::array<char, 32768> answer;
  const std::size_t size = ask_for_link(interface, answer.data(), answer.size());
  if (size < kHead || reinterpret_cast<const nlmsghdr*>(answer.data())->nlmsg_type != RTM_NEWLINK) return master;
  for_each_attribute(answer.data() + kHead, size - kHead, [&master](int type, const void* data, std::size_t length) {
    if (type == IFLA_MASTER) master.name = name_of(data, length);
    if (type == IFLA_LINKINFO) master.kind = kind_in(data, length);
  });
  return master;
}

}  // namespace adhoc_communication
