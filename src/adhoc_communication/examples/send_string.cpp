// Sends a text to another robot: rosrun adhoc_communication send_string ROBOT TOPIC TEXT
// The receiving robot publishes it as adhoc_communication/RecvString on TOPIC.
#include <adhoc_communication/SendString.h>
#include <ros/ros.h>

#include <iostream>

int main(int argc, char** argv) {
  ros::init(argc, argv, "send_string", ros::init_options::AnonymousName);
  if (argc != 4) {
    std::cerr << "usage: send_string ROBOT TOPIC TEXT\n";
    return 2;
  }
  ros::NodeHandle node;
  auto client = node.serviceClient<adhoc_communication::SendString>("adhoc_communication/send_string");
  if (!client.waitForExistence(ros::Duration(5.0))) {
    std::cerr << "not delivered: adhoc_communication does not run here\n";
    return 1;
  }
  adhoc_communication::SendString call;
  call.request.dst_robot = argv[1];
  call.request.topic = argv[2];
  call.request.data = argv[3];
  if (!client.call(call)) {  // roscpp logs the reason
    std::cerr << "not delivered\n";
    return 1;
  }
  std::cout << "delivered\n";
}
