// The header lines of the logs, as in the original.
#pragma once

namespace adhoc_communication::log_columns {

inline constexpr char kServices[] = "#time,service,time_call,time_res,data_size,return";
inline constexpr char kTransportFrames[] =
    "#time,id,dst,retransmissions,start_time,end_time,success,route_length,route,multicast";
inline constexpr char kLinkFrames[] = "#time,src,frame_id,mac_src,mac_dst,time_sent,time_ack,retransmissions";
inline constexpr char kUnicastSummary[] =
    "#time,num_unique_data_frames_sent,num_unique_data_frames_forwarded,num_data_frames_resent,"
    "num_data_frames_reforwarded,num_data_frames_relayed,num_acknowledgments_sent,num_acknowledgments_relayed,"
    "num_rreq_sent,num_rrep_sent,num_beacons_sent,num_relay_selection_sent,num_relay_detecion_sent,"
    "num_total_frames_sent,num_unique_data_frames_received_directly,num_unique_data_frames_received_relay,"
    "num_data_frames_received_directly,num_data_frames_received_relay,num_acknowledgments_received_directly,"
    "num_acknowledgments_received_relay,num_rreq_received,num_rrep_received,num_relay_selection_received,"
    "num_relay_detecion_received,num_duplicate_frames_received,num_beacons_received,num_total_frames_received,"
    "num_total_bytes_sent,num_total_bytes_received";
inline constexpr char kMulticastSummary[] =
    "#time,num_mc_unique_data_frames_sent,num_mc_unique_data_frames_forwarded,num_mc_data_frames_resent,"
    "num_mc_data_frames_reforwarded,num_mc_data_frames_relayed,num_mc_acknowledgments_sent,"
    "num_mc_acknowledgments_relayed,num_mc_rreq_sent,num_mc_rrep_sent,num_mc_ract_sent,num_mc_relay_selection_sent,"
    "num_mc_total_frames_sent,num_mc_unique_data_frames_received_directly,num_mc_unique_data_frames_received_relay,"
    "num_mc_data_frames_received_directly,num_mc_data_frames_received_relay,num_mc_acknowledgments_received_directly,"
    "num_mc_acknowledgments_received_relay,num_mc_rreq_received,num_mc_rrep_received,num_mc_ract_received,"
    "num_mc_relay_selection_received,num_mc_duplicate_frames_received,num_mc_total_frames_received,"
    "num_mc_total_bytes_sent,num_mc_total_bytes_received";
inline constexpr char kMemory[] =
    "#time,size_multicast_packets_complete,size_multicast_packets_incomplete,size_unicast_packets_incomplete,"
    "size_unack_relay_frames,running_unicast_link_threads,running_multicast_threads,running_unicast_cr_threads,"
    "running_unicast_transport_threads";
inline constexpr char kRoutingTable[] = "#time,num_cr_entries,num_unicast_entries,num_multicast_entries,size";
inline constexpr char kSearches[] =
    "#time,rreq_id,dst,start_time,end_time,num_rrep_rcvd,num_rreq_sent,route_length,route,multicast";
inline constexpr char kRequestsArrived[] = "#time,rreq_id,src,counter,route_length,selected,route";
inline constexpr char kRequestsPassedOn[] = "#time,rreq_id,src,rcvd_from";

}  // namespace adhoc_communication::log_columns
