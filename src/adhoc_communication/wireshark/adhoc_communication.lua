-- Wireshark dissector for the frames of adhoc_communication (docs/protocol.md).
--
--   wireshark -X lua_script:adhoc_communication.lua capture.pcap
--
-- or copy it to the folder that Help > About Wireshark > Folders calls "Personal Lua Plugins". The bodies of sealed
-- frames stay closed: the dissector knows no keys.

local adhoc = Proto("adhoc", "Ad hoc communication of robots")

local ETHERTYPE = 0x88B5
local HEADER_SIZE = 43
local CHECKSUM_SIZE = 4
local TAG_SIZE = 16

local SEALED, WANTS_ACKNOWLEDGMENT, ACKNOWLEDGE_NOW = 0x01, 0x02, 0x04

local TYPES = {
  [1] = "Beacon", [2] = "Route request", [3] = "Route reply", [4] = "Route error", [5] = "Hop acknowledgment",
  [6] = "Data", [7] = "Transport acknowledgment", [8] = "Broadcast data", [9] = "Flood", [10] = "Group activation",
  [11] = "Group refusal", [12] = "Group data", [13] = "Group report",
  [14] = "Route reply acknowledgment", [15] = "Group receipts",
}
local PRIORITIES = { [0] = "control", [1] = "position", [2] = "normal", [3] = "bulk" }
local PACKET_KINDS = {
  [0] = "user", [1] = "group join", [2] = "group leave", [3] = "group members request", [4] = "group members",
  [5] = "group copy",
}
local PAYLOAD_TYPES = {
  [0x41] = "string (A)", [0x4D] = "map (M)", [0x50] = "position (P)", [0x70] = "point (p)", [0x55] = "map update (U)",
  [0x43] = "control (C)", [0x46] = "frontier (F)", [0x63] = "cluster (c)", [0x61] = "auction (a)",
  [0x54] = "twist (T)", [0x51] = "quaternion (Q)", [0x52] = "robot update (R)", [0x58] = "any message (X)",
  [0x78] = "message without definition (x)", [0x44] = "definition (D)", [0x64] = "definition request (d)",
  [0x6E] = "new member (n)",
}

local YES_NO = { "Set", "Not set" }

local f = {
  version = ProtoField.uint8("adhoc.version", "Version"),
  type = ProtoField.uint8("adhoc.type", "Type", base.DEC, TYPES),
  flags = ProtoField.uint8("adhoc.flags", "Flags", base.HEX),
  sealed = ProtoField.bool("adhoc.flags.sealed", "Sealed", 8, YES_NO, SEALED),
  wants_acknowledgment = ProtoField.bool("adhoc.flags.wants_acknowledgment", "Wants acknowledgment", 8, YES_NO,
                                         WANTS_ACKNOWLEDGMENT),
  acknowledge_now = ProtoField.bool("adhoc.flags.acknowledge_now", "Acknowledge now", 8, YES_NO, ACKNOWLEDGE_NOW),
  sender = ProtoField.ether("adhoc.sender", "Sender"),
  boot_id = ProtoField.bytes("adhoc.boot_id", "Boot id of the sender"),
  counter = ProtoField.uint64("adhoc.counter", "Frame counter"),
  next_hop = ProtoField.ether("adhoc.next_hop", "Next hop"),
  link_sequence = ProtoField.uint32("adhoc.link_sequence", "Link sequence"),
  sealed_body = ProtoField.bytes("adhoc.sealed_body", "Encrypted body"),
  tag = ProtoField.bytes("adhoc.tag", "Authentication tag"),
  checksum = ProtoField.uint32("adhoc.checksum", "Checksum", base.HEX),
  checksum_good = ProtoField.bool("adhoc.checksum_good", "Checksum is right"),

  sequence = ProtoField.uint32("adhoc.sequence", "Sequence number"),
  alive = ProtoField.uint32("adhoc.alive", "Life sign"),
  name = ProtoField.string("adhoc.name", "Name"),
  beacon_number = ProtoField.uint16("adhoc.beacon_number", "Number of the beacon"),
  heard_count = ProtoField.uint16("adhoc.heard_count", "Neighbours heard"),
  named_count = ProtoField.uint8("adhoc.named_count", "Neighbours named here"),
  heard = ProtoField.bytes("adhoc.heard", "Neighbour heard (beginning of its boot id)"),
  loss = ProtoField.uint8("adhoc.loss", "Loss of its beacons (255ths)"),
  rumor_count = ProtoField.uint8("adhoc.rumor_count", "Rumours"),
  robot = ProtoField.ether("adhoc.robot", "Robot"),
  boot_tag = ProtoField.bytes("adhoc.boot_tag", "Boot tag"),
  hops = ProtoField.uint8("adhoc.hops", "Hops"),

  routing_flags = ProtoField.uint8("adhoc.routing_flags", "Flags", base.HEX),
  request_join = ProtoField.bool("adhoc.request.join", "J: join", 8, YES_NO, 0x80),
  request_repair = ProtoField.bool("adhoc.request.repair", "R: repair", 8, YES_NO, 0x40),
  request_gratuitous = ProtoField.bool("adhoc.request.gratuitous", "G: gratuitous reply", 8, YES_NO, 0x20),
  request_destination_only = ProtoField.bool("adhoc.request.destination_only", "D: destination only", 8, YES_NO, 0x10),
  request_unknown = ProtoField.bool("adhoc.request.unknown_sequence", "U: unknown sequence number", 8, YES_NO, 0x08),
  request_directed = ProtoField.bool("adhoc.request.directed", "Directed: not flooded", 8, YES_NO, 0x04),
  reply_repair = ProtoField.bool("adhoc.reply.repair", "R: repair", 8, YES_NO, 0x80),
  reply_acknowledgment = ProtoField.bool("adhoc.reply.acknowledgment", "A: acknowledgment required", 8, YES_NO, 0x40),
  error_no_delete = ProtoField.bool("adhoc.error.no_delete", "N: no delete", 8, YES_NO, 0x80),
  error_unknown = ProtoField.bool("adhoc.error.unknown_sequence", "Numbers unknown", 8, YES_NO, 0x40),
  hop_count = ProtoField.uint8("adhoc.hop_count", "Hop count"),
  hop_limit = ProtoField.uint8("adhoc.hop_limit", "Hop limit"),
  cost = ProtoField.uint16("adhoc.cost", "Cost (sixteenths of a transmission)"),
  id = ProtoField.uint32("adhoc.id", "Id"),
  destination = ProtoField.ether("adhoc.destination", "Destination"),
  destination_sequence = ProtoField.uint32("adhoc.destination_sequence", "Destination sequence number"),
  destination_boot = ProtoField.bytes("adhoc.destination_boot", "Boot tag of the destination"),
  destination_name = ProtoField.string("adhoc.destination_name", "Destination name"),
  originator = ProtoField.ether("adhoc.originator", "Originator"),
  originator_sequence = ProtoField.uint32("adhoc.originator_sequence", "Originator sequence number"),
  originator_boot = ProtoField.bytes("adhoc.originator_boot", "Boot tag of the originator"),
  originator_name = ProtoField.string("adhoc.originator_name", "Originator name"),
  lifetime = ProtoField.uint32("adhoc.lifetime", "Lifetime (ms)"),
  unreachable_count = ProtoField.uint8("adhoc.unreachable_count", "Unreachable destinations"),
  extension_type = ProtoField.uint8("adhoc.extension.type", "Extension type"),
  extension_data = ProtoField.bytes("adhoc.extension.data", "Extension data"),

  newest_counter = ProtoField.uint64("adhoc.newest_counter", "Newest counter received"),
  spacing = ProtoField.uint32("adhoc.spacing", "Spacing of arrivals (ns)"),
  held = ProtoField.uint32("adhoc.held", "Held back since its arrival (ns)"),
  highest = ProtoField.uint32("adhoc.highest", "Highest link sequence"),
  received = ProtoField.uint64("adhoc.received", "Received (bit i: highest - i)", base.HEX),

  source = ProtoField.ether("adhoc.source", "Source"),
  source_boot = ProtoField.bytes("adhoc.source_boot", "Boot tag of the source"),
  source_name = ProtoField.string("adhoc.source_name", "Source name"),
  stream = ProtoField.uint8("adhoc.stream", "Stream", base.HEX),
  priority = ProtoField.uint8("adhoc.priority", "Priority", base.DEC, PRIORITIES, 0x03),
  end_to_end_now = ProtoField.bool("adhoc.stream.acknowledge_now", "Acknowledge now", 8, YES_NO, 0x80),
  packet = ProtoField.uint32("adhoc.packet", "Packet"),
  base = ProtoField.uint32("adhoc.base", "Base"),
  index = ProtoField.uint32("adhoc.index", "Segment"),
  total = ProtoField.uint32("adhoc.total", "Octets of the packet"),
  segment_size = ProtoField.uint16("adhoc.segment_size", "Segment size"),
  attempt = ProtoField.uint8("adhoc.attempt", "Attempt"),
  segment = ProtoField.bytes("adhoc.segment", "Octets of the segment"),
  next_packet = ProtoField.uint32("adhoc.next_packet", "Next packet"),
  partial_count = ProtoField.uint8("adhoc.partial_count", "Unfinished packets"),
  refused_count = ProtoField.uint8("adhoc.refused_count", "Packets without room"),
  first_missing = ProtoField.uint32("adhoc.first_missing", "First missing segment"),
  bitmap_size = ProtoField.uint8("adhoc.bitmap_size", "Octets of the bitmap"),
  bitmap = ProtoField.bytes("adhoc.bitmap", "Received behind it (least significant bit first)"),

  root = ProtoField.ether("adhoc.root", "Root"),
  root_boot = ProtoField.bytes("adhoc.root_boot", "Boot tag of the root"),
  epoch = ProtoField.uint32("adhoc.epoch", "Epoch"),
  member_count = ProtoField.uint8("adhoc.member_count", "Members"),
  member = ProtoField.ether("adhoc.member", "Member"),
  group_report = ProtoField.bool("adhoc.stream.report", "Asks for a report", 8, YES_NO, 0x80),
  group_follows = ProtoField.bool("adhoc.stream.follows", "Follows the frame before without a gap", 8, YES_NO, 0x40),
  group_flooded = ProtoField.bool("adhoc.stream.flooded", "Everybody passes it on", 8, YES_NO, 0x20),
  receipt_by_route = ProtoField.bool("adhoc.stream.by_route", "By the route", 8, YES_NO, 0x80),
  group_complete = ProtoField.bool("adhoc.stream.complete", "Complete", 8, YES_NO, 0x80),
  next_packet = ProtoField.uint32("adhoc.next_packet", "Delivered before"),
  beyond = ProtoField.uint32("adhoc.beyond", "There behind it (bits)", base.HEX),
  round = ProtoField.uint16("adhoc.round", "Round"),
  block = ProtoField.uint16("adhoc.block", "Block"),
  symbol = ProtoField.uint8("adhoc.symbol", "Symbol"),
  measured_counter = ProtoField.uint64("adhoc.measured_counter", "Measured counter"),
  coverage = ProtoField.uint32("adhoc.coverage", "Coverage", base.HEX),
  first_block = ProtoField.uint16("adhoc.first_block", "First open block"),
  missing = ProtoField.uint8("adhoc.missing", "Missing of a block"),

  image_flags = ProtoField.uint8("adhoc.image.flags", "Flags", base.HEX),
  image_compressed = ProtoField.bool("adhoc.image.compressed", "Compressed (zstd)", 8, YES_NO, 0x01),
  image_latched = ProtoField.bool("adhoc.image.latched", "Latched", 8, YES_NO, 0x02),
  image_kind = ProtoField.uint8("adhoc.image.kind", "Kind", base.DEC, PACKET_KINDS),
  image_payload_type = ProtoField.uint8("adhoc.image.payload_type", "Payload type", base.HEX, PAYLOAD_TYPES),
  image_group = ProtoField.string("adhoc.image.group", "Group"),
  image_topic = ProtoField.string("adhoc.image.topic", "Topic"),
  image_payload_size = ProtoField.uint32("adhoc.image.payload_size", "Payload size"),
  image_payload = ProtoField.bytes("adhoc.image.payload", "Payload"),
}
adhoc.fields = f

local malformed = ProtoExpert.new("adhoc.malformed", "Malformed frame", expert.group.MALFORMED, expert.severity.ERROR)
local wrong_checksum = ProtoExpert.new("adhoc.wrong_checksum", "Wrong checksum", expert.group.CHECKSUM,
                                       expert.severity.ERROR)
adhoc.experts = { malformed, wrong_checksum }

-- A place in the octets that moves on with each field. take() fails when the frame ends before the field does.
local Cursor = {}
Cursor.__index = Cursor

function Cursor.new(range)
  return setmetatable({ range = range, at = 0 }, Cursor)
end

function Cursor:left()
  return self.range:len() - self.at
end

function Cursor:take(size)
  if size > self:left() then error("the frame ends too early", 0) end
  local taken = self.range:range(self.at, size)
  self.at = self.at + size
  return taken
end

-- Adds a field of `size` octets and returns its range.
function Cursor:add(tree, field, size)
  if size == 0 then return nil end
  local range = self:take(size)
  tree:add(field, range)
  return range
end

function Cursor:number(tree, field, size)
  return self:add(tree, field, size):uint()
end

-- A text behind its length of `length_size` octets.
function Cursor:text(tree, field, length_size)
  local size = self:take(length_size):uint()
  local range = self:add(tree, field, size)
  return range and range:string() or ""
end

-- An octet of flags, with the meaning of each bit below it.
function Cursor:flags(tree, field, bits)
  local range = self:take(1)
  local item = tree:add(field, range)
  for _, bit_field in ipairs(bits) do item:add(bit_field, range) end
  return range:uint()
end

function Cursor:rest(tree, field)
  return self:add(tree, field, self:left())
end

-- RFC 3561 section 9.
local function extensions(cursor, tree)
  while cursor:left() > 0 do
    cursor:add(tree, f.extension_type, 1)
    local size = cursor:take(1):uint()
    cursor:add(tree, f.extension_data, size)
  end
end

-- `whole` is false when only the first segment of the packet is at hand.
local function image(cursor, tree, whole)
  local start = cursor.at
  local branch = tree:add(adhoc, cursor.range:range(start), "Packet image")
  cursor:flags(branch, f.image_flags, { f.image_compressed, f.image_latched })
  cursor:add(branch, f.image_kind, 1)
  cursor:add(branch, f.image_payload_type, 1)
  cursor:text(branch, f.image_group, 1)
  local topic = cursor:text(branch, f.image_topic, 2)
  cursor:add(branch, f.image_payload_size, 4)
  cursor:rest(branch, f.image_payload)
  if not whole then branch:append_text(" (first segment)") end
  return topic
end

local function segment(cursor, tree, index, total)
  if index > 0 then
    cursor:rest(tree, f.segment)
    return ""
  end
  local whole = cursor:left() == total
  -- The beginning of an image may be longer than one segment: then it is shown as octets.
  local at = cursor.at
  local fits, topic = pcall(image, cursor, tree, whole)
  if fits then return topic end
  cursor.at = at
  cursor:rest(tree, f.segment)
  return ""
end

local function beacon(cursor, tree)
  cursor:add(tree, f.sequence, 4)
  cursor:add(tree, f.alive, 4)
  cursor:add(tree, f.beacon_number, 2)
  local name = cursor:text(tree, f.name, 1)
  local all = cursor:number(tree, f.heard_count, 2)
  local heard = cursor:number(tree, f.named_count, 1)
  for _ = 1, heard do
    local branch = tree:add(f.heard, cursor:take(6))
    cursor:add(branch, f.loss, 1)
  end
  local rumors = cursor:number(tree, f.rumor_count, 1)
  for _ = 1, rumors do
    local branch = tree:add(f.robot, cursor:take(6))
    cursor:add(branch, f.boot_tag, 8)
    cursor:add(branch, f.alive, 4)
    cursor:add(branch, f.hops, 1)
    cursor:text(branch, f.name, 1)
  end
  extensions(cursor, tree)
  return string.format("%s, hears %d, %d rumours", name, math.max(all, heard), rumors)
end

local function route_request(cursor, tree)
  cursor:flags(tree, f.routing_flags, { f.request_join, f.request_repair, f.request_gratuitous,
                                        f.request_destination_only, f.request_unknown, f.request_directed })
  local hops = cursor:number(tree, f.hop_count, 1)
  local limit = cursor:number(tree, f.hop_limit, 1)
  cursor:add(tree, f.cost, 2)
  cursor:add(tree, f.id, 4)
  cursor:add(tree, f.destination, 6)
  cursor:add(tree, f.destination_sequence, 4)
  cursor:add(tree, f.originator, 6)
  cursor:add(tree, f.originator_sequence, 4)
  cursor:add(tree, f.originator_boot, 8)
  local destination = cursor:text(tree, f.destination_name, 1)
  local originator = cursor:text(tree, f.originator_name, 1)
  extensions(cursor, tree)
  return string.format("%s looks for %s, %d of %d hops", originator, destination, hops, limit)
end

local function route_reply(cursor, tree)
  cursor:flags(tree, f.routing_flags, { f.reply_repair, f.reply_acknowledgment })
  local hops = cursor:number(tree, f.hop_count, 1)
  cursor:add(tree, f.cost, 2)
  cursor:add(tree, f.destination, 6)
  cursor:add(tree, f.destination_sequence, 4)
  cursor:add(tree, f.destination_boot, 8)
  cursor:add(tree, f.originator, 6)
  cursor:add(tree, f.lifetime, 4)
  local destination = cursor:text(tree, f.destination_name, 1)
  extensions(cursor, tree)
  return string.format("%s is %d hops away", destination, hops + 1)
end

local function route_error(cursor, tree)
  cursor:flags(tree, f.routing_flags, { f.error_no_delete, f.error_unknown })
  local count = cursor:number(tree, f.unreachable_count, 1)
  for _ = 1, count do
    local branch = tree:add(f.destination, cursor:take(6))
    cursor:add(branch, f.destination_sequence, 4)
  end
  extensions(cursor, tree)
  return string.format("%d unreachable", count)
end

local function hop_acknowledgment(cursor, tree)
  cursor:add(tree, f.boot_tag, 8)
  cursor:add(tree, f.newest_counter, 8)
  cursor:add(tree, f.spacing, 4)
  cursor:add(tree, f.held, 4)
  local highest = cursor:number(tree, f.highest, 4)
  cursor:add(tree, f.received, 8)
  return string.format("up to %d", highest)
end

local function data(cursor, tree)
  cursor:add(tree, f.source, 6)
  cursor:add(tree, f.source_boot, 8)
  cursor:add(tree, f.destination, 6)
  cursor:flags(tree, f.stream, { f.priority, f.end_to_end_now })
  local hops = cursor:number(tree, f.hops, 1)
  local packet = cursor:number(tree, f.packet, 4)
  cursor:add(tree, f.base, 4)
  local index = cursor:number(tree, f.index, 4)
  local total = cursor:number(tree, f.total, 4)
  cursor:add(tree, f.segment_size, 2)
  cursor:add(tree, f.attempt, 1)
  local topic = segment(cursor, tree, index, total)
  return string.format("packet %d, segment %d, hop %d %s", packet, index, hops, topic)
end

local function transport_acknowledgment(cursor, tree)
  cursor:add(tree, f.source, 6)
  cursor:add(tree, f.source_boot, 8)
  cursor:add(tree, f.destination, 6)
  cursor:add(tree, f.destination_boot, 8)
  cursor:flags(tree, f.stream, { f.priority })
  cursor:add(tree, f.hops, 1)
  local next_packet = cursor:number(tree, f.next_packet, 4)
  local count = cursor:number(tree, f.partial_count, 1)
  for _ = 1, count do
    local branch = tree:add(f.packet, cursor:take(4))
    cursor:add(branch, f.attempt, 1)
    cursor:add(branch, f.first_missing, 4)
    local size = cursor:number(branch, f.bitmap_size, 1)
    cursor:add(branch, f.bitmap, size)
  end
  local refused = cursor:number(tree, f.refused_count, 1)
  for _ = 1, refused do
    local branch = tree:add(f.packet, cursor:take(4))
    cursor:add(branch, f.attempt, 1)
  end
  return string.format("next packet %d, %d unfinished, %d refused", next_packet, count, refused)
end

local function broadcast_data(cursor, tree)
  local packet = cursor:number(tree, f.packet, 4)
  local index = cursor:number(tree, f.index, 4)
  local total = cursor:number(tree, f.total, 4)
  cursor:add(tree, f.segment_size, 2)
  local topic = segment(cursor, tree, index, total)
  return string.format("packet %d, segment %d %s", packet, index, topic)
end

local function flood(cursor, tree)
  cursor:add(tree, f.source, 6)
  cursor:add(tree, f.source_boot, 8)
  cursor:add(tree, f.id, 4)
  local hops = cursor:number(tree, f.hop_count, 1)
  local limit = cursor:number(tree, f.hop_limit, 1)
  local source = cursor:text(tree, f.source_name, 1)
  local topic = image(cursor, tree, true)
  return string.format("from %s, %d of %d hops %s", source, hops, limit, topic)
end

-- The body of group activation and group refusal.
local function group_branch(cursor, tree)
  cursor:add(tree, f.root, 6)
  cursor:add(tree, f.root_boot, 8)
  local epoch = cursor:number(tree, f.epoch, 4)
  local count = cursor:number(tree, f.member_count, 1)
  for _ = 1, count do cursor:add(tree, f.member, 6) end
  return string.format("epoch %d, %d members", epoch, count)
end

local function group_data(cursor, tree)
  cursor:add(tree, f.root, 6)
  cursor:add(tree, f.root_boot, 8)
  cursor:flags(tree, f.stream, { f.priority, f.group_report, f.group_follows, f.group_flooded })
  local hops = cursor:number(tree, f.hops, 1)
  local round = cursor:number(tree, f.round, 2)
  local packet = cursor:number(tree, f.packet, 4)
  cursor:add(tree, f.base, 4)
  local total = cursor:number(tree, f.total, 4)
  cursor:add(tree, f.segment_size, 2)
  local block = cursor:number(tree, f.block, 2)
  local symbol = cursor:number(tree, f.symbol, 1)
  if cursor:left() == 0 then return string.format("packet %d, question of round %d", packet, round) end
  local topic = segment(cursor, tree, block + symbol, total)
  return string.format("packet %d, block %d, symbol %d, hop %d %s", packet, block, symbol, hops, topic)
end

local function group_report(cursor, tree)
  cursor:add(tree, f.root, 6)
  cursor:add(tree, f.root_boot, 8)
  local stream = cursor:flags(tree, f.stream, { f.priority, f.group_complete })
  local packet = cursor:number(tree, f.packet, 4)
  cursor:add(tree, f.epoch, 4)
  local round = cursor:number(tree, f.round, 2)
  cursor:add(tree, f.measured_counter, 8)
  cursor:add(tree, f.spacing, 4)
  cursor:add(tree, f.coverage, 4)
  local first_block = cursor:number(tree, f.first_block, 2)
  local open = cursor:left()
  for _ = 1, open do cursor:add(tree, f.missing, 1) end
  local state = bit.band(stream, 0x80) ~= 0 and "complete" or open .. " open blocks"
  if first_block == 0xffff then state = "no room" end
  return string.format("packet %d, round %d, %s", packet, round, state)
end

local function group_receipts(cursor, tree)
  local count = cursor:number(tree, f.member_count, 1)
  for _ = 1, count do
    cursor:add(tree, f.root, 6)
    cursor:add(tree, f.root_boot, 8)
    cursor:flags(tree, f.stream, { f.priority, f.receipt_by_route })
    cursor:add(tree, f.member, 6)
    cursor:number(tree, f.next_packet, 4)
    cursor:add(tree, f.beyond, 4)
  end
  return string.format("of %d members", count)
end

local function nothing() return "" end

local BODIES = { beacon, route_request, route_reply, route_error, hop_acknowledgment, data, transport_acknowledgment,
                 broadcast_data, flood, group_branch, group_branch, group_data, group_report, nothing, group_receipts }

-- CRC-32 of IEEE 802.3, reflected.
local function crc32(octets)
  local value = 0xffffffff
  for i = 0, octets:len() - 1 do
    value = bit.bxor(value, octets:get_index(i))
    for _ = 1, 8 do
      local low = bit.band(value, 1)
      value = bit.rshift(value, 1)
      if low == 1 then value = bit.bxor(value, 0xedb88320) end
    end
  end
  return bit.bnot(value) % 0x100000000
end

local function header(cursor, tree)
  cursor:add(tree, f.version, 1)
  local kind = cursor:number(tree, f.type, 1)
  local flags = cursor:flags(tree, f.flags, { f.sealed, f.wants_acknowledgment, f.acknowledge_now })
  cursor:add(tree, f.sender, 6)
  cursor:add(tree, f.boot_id, 16)
  cursor:add(tree, f.counter, 8)
  cursor:add(tree, f.next_hop, 6)
  cursor:add(tree, f.link_sequence, 4)
  return kind, bit.band(flags, SEALED) ~= 0
end

local function check(buffer, tree)
  local size = buffer:len() - CHECKSUM_SIZE
  local range = buffer:range(size, CHECKSUM_SIZE)
  tree:add(f.checksum, range)
  local good = crc32(buffer:range(0, size):bytes()) == range:uint()
  tree:add(f.checksum_good, range, good):set_generated()
  if not good then tree:add_proto_expert_info(wrong_checksum) end
end

local function sealed_frame(buffer, tree)
  local body = buffer:len() - HEADER_SIZE - TAG_SIZE
  if body > 0 then tree:add(f.sealed_body, buffer:range(HEADER_SIZE, body)) end
  tree:add(f.tag, buffer:range(buffer:len() - TAG_SIZE, TAG_SIZE))
  return "sealed"
end

local function open_frame(buffer, tree, kind)
  check(buffer, tree)
  local body = buffer:range(HEADER_SIZE, buffer:len() - HEADER_SIZE - CHECKSUM_SIZE)
  local cursor = Cursor.new(body)
  local text = BODIES[kind](cursor, tree:add(adhoc, body, TYPES[kind]))
  if cursor:left() > 0 then error("octets behind the end of the body", 0) end
  return text
end

-- The version decides the layout of all that follows.
local function frame(buffer, tree)
  local version = buffer:range(0, 1):uint()
  if version ~= 2 then error("unknown version " .. version, 0) end
  local kind, sealed = header(Cursor.new(buffer:range(0)), tree)
  if BODIES[kind] == nil then error("unknown type " .. kind, 0) end
  if buffer:len() < HEADER_SIZE + (sealed and TAG_SIZE or CHECKSUM_SIZE) then error("the frame ends too early", 0) end
  local text = sealed and sealed_frame(buffer, tree) or open_frame(buffer, tree, kind)
  return TYPES[kind] .. ": " .. text
end

function adhoc.dissector(buffer, pinfo, tree)
  if buffer:len() == 0 then return 0 end
  pinfo.cols.protocol = "ADHOC"
  local branch = tree:add(adhoc, buffer(), "Ad hoc communication")
  local understood, text = pcall(frame, buffer, branch)
  if not understood then
    branch:add_proto_expert_info(malformed, tostring(text))
    text = "Malformed: " .. tostring(text)
  end
  pinfo.cols.info = text
  return buffer:len()
end

DissectorTable.get("ethertype"):add(ETHERTYPE, adhoc)
