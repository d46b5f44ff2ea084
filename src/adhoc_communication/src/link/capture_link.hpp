// A link whose frames are written down as they pass.
#pragma once

#include <memory>

#include "link/capture_file.hpp"
#include "link/link.hpp"

namespace adhoc_communication {

class CaptureLink : public Link {
 public:
  CaptureLink(std::unique_ptr<Link> link, std::shared_ptr<CaptureFile> file)
      : link_(std::move(link)), file_(std::move(file)) {}

  int descriptor() const override { return link_->descriptor(); }
  int receive(const FrameTaker& take) override;
  using Link::send;
  void send(const Frame* first, std::size_t count) override;
  bool keeps_frames() const override { return link_->keeps_frames(); }
  void tend() override { link_->tend(); }
  bool is_up() const override { return link_->is_up(); }
  std::string trouble() const override { return link_->trouble(); }
  MacAddress address() const override { return link_->address(); }
  int mtu() const override { return link_->mtu(); }
  std::uint64_t frames_not_sent() const override { return link_->frames_not_sent(); }
  std::uint64_t frames_missed() const override { return link_->frames_missed(); }

 private:
  std::unique_ptr<Link> link_;
  std::shared_ptr<CaptureFile> file_;
};

}  // namespace adhoc_communication
