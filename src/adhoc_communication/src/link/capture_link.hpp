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
  std::optional<Frame> receive() override;
  void send(const Frame& frame) override;
  void tend() override { link_->tend(); }
  bool is_up() const override { return link_->is_up(); }
  MacAddress address() const override { return link_->address(); }
  int mtu() const override { return link_->mtu(); }

 private:
  std::unique_ptr<Link> link_;
  std::shared_ptr<CaptureFile> file_;
};

}  // namespace adhoc_communication
