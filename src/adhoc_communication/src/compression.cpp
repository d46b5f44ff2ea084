#include "adhoc_communication/compression.hpp"

#include "transport/packet_image.hpp"

namespace adhoc_communication {

void pack(SendRequest& request) { transport::pack(request.payload, request.unpacked_size); }

void pack(BroadcastRequest& request) { transport::pack(request.payload, request.unpacked_size); }

bool unpack(PacketReceived& packet) { return transport::unpack(packet.payload, packet.unpacked_size); }

}  // namespace adhoc_communication
