// SPDX-License-Identifier: Apache-2.0
// A participant of DDS written with Fast DDS, and with messages of ROS 2 written out by hand.
//
//   fast_dds_peer DOMAIN
//
// It subscribes to rt/request/NAME for each message NAME, prints every value that arrives, one line
// for each message, and publishes the same message on rt/answer/NAME. It also prints what it hears
// on rt/latched, to which it subscribes as to a latched topic. It ends when its input ends.
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// The messages, as their .msg files define them.

struct Time {
  std::int32_t sec{};
  std::uint32_t nanosec{};
  auto fields() { return std::tie(sec, nanosec); }
};
struct Header {
  Time stamp;
  std::string frame_id;
  auto fields() { return std::tie(stamp, frame_id); }
};
struct Bool {
  bool data{};
  auto fields() { return std::tie(data); }
};
struct Int8 {
  std::int8_t data{};
  auto fields() { return std::tie(data); }
};
struct Float64 {
  double data{};
  auto fields() { return std::tie(data); }
};
struct String {
  std::string data;
  auto fields() { return std::tie(data); }
};
struct MultiArrayDimension {
  std::string label;
  std::uint32_t size{}, stride{};
  auto fields() { return std::tie(label, size, stride); }
};
struct Float64MultiArray {
  std::vector<MultiArrayDimension> dim;
  std::uint32_t data_offset{};
  std::vector<double> data;
  auto fields() { return std::tie(dim, data_offset, data); }
};
struct Vector3 {
  double x{}, y{}, z{};
  auto fields() { return std::tie(x, y, z); }
};
struct Quaternion {
  double x{}, y{}, z{}, w{};
  auto fields() { return std::tie(x, y, z, w); }
};
struct Twist {
  Vector3 linear, angular;
  auto fields() { return std::tie(linear, angular); }
};
struct TwistStamped {
  Header header;
  Twist twist;
  auto fields() { return std::tie(header, twist); }
};
struct Pose {
  Vector3 position;
  Quaternion orientation;
  auto fields() { return std::tie(position, orientation); }
};
struct Odometry {
  Header header;
  std::string child_frame_id;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  Twist twist;
  std::array<double, 36> twist_covariance{};
  auto fields() {
    return std::tie(header, child_frame_id, pose, pose_covariance, twist, twist_covariance);
  }
};
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Vector3 translation;
  Quaternion rotation;
  auto fields() { return std::tie(header, child_frame_id, translation, rotation); }
};
struct TFMessage {
  std::vector<TransformStamped> transforms;
  auto fields() { return std::tie(transforms); }
};
struct JointState {
  Header header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;
  auto fields() { return std::tie(header, name, position, velocity, effort); }
};
struct BatteryState {
  Header header;
  std::array<float, 7> numbers{};
  std::array<std::uint8_t, 3> codes{};
  bool present{};
  std::vector<float> cell_voltage, cell_temperature;
  std::string location, serial_number;
  auto fields() {
    return std::tie(header, numbers, codes, present, cell_voltage, cell_temperature, location,
                    serial_number);
  }
};
struct JointTrajectoryPoint {
  std::vector<double> positions, velocities, accelerations, effort;
  Time time_from_start;
  auto fields() { return std::tie(positions, velocities, accelerations, effort, time_from_start); }
};
struct JointTrajectory {
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
  auto fields() { return std::tie(header, joint_names, points); }
};
struct KeyValue {
  std::string key, value;
  auto fields() { return std::tie(key, value); }
};
struct DiagnosticStatus {
  std::uint8_t level{};
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
  auto fields() { return std::tie(level, name, message, hardware_id, values); }
};
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
  auto fields() { return std::tie(header, status); }
};

template <class T>
struct is_vector : std::false_type {};
template <class T>
struct is_vector<std::vector<T>> : std::true_type {};
template <class T>
struct is_array : std::false_type {};
template <class T, std::size_t n>
struct is_array<std::array<T, n>> : std::true_type {};
template <class T>
inline constexpr bool is_leaf = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

template <class T>
void write(Cdr& cdr, T& value) {
  if constexpr (is_leaf<T>) {
    cdr << value;
  } else if constexpr (is_vector<T>::value || is_array<T>::value) {
    if constexpr (is_vector<T>::value) cdr << static_cast<std::uint32_t>(value.size());
    for (auto& one : value) write(cdr, one);
  } else {
    std::apply([&](auto&... field) { (write(cdr, field), ...); }, value.fields());
  }
}

template <class T>
void read(Cdr& cdr, T& value) {
  if constexpr (is_leaf<T>) {
    cdr >> value;
  } else if constexpr (is_vector<T>::value || is_array<T>::value) {
    if constexpr (is_vector<T>::value) {
      std::uint32_t size = 0;
      cdr >> size;
      value.resize(size);
    }
    for (auto& one : value) read(cdr, one);
  } else {
    std::apply([&](auto&... field) { (read(cdr, field), ...); }, value.fields());
  }
}

// Every value in order; texts as hexadecimal bytes, sequences after their length.
template <class T>
void show(std::string& line, T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    line += " x";
    char digits[3];
    for (const unsigned char byte : value) {
      std::snprintf(digits, sizeof digits, "%02x", byte);
      line += digits;
    }
  } else if constexpr (std::is_arithmetic_v<T>) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", static_cast<double>(value));
    line += text;
  } else if constexpr (is_vector<T>::value || is_array<T>::value) {
    if constexpr (is_vector<T>::value) line += " " + std::to_string(value.size());
    for (auto& one : value) show(line, one);
  } else {
    std::apply([&](auto&... field) { (show(line, field), ...); }, value.fields());
  }
}

constexpr std::uint32_t largest = 65536;

template <class Message>
class Type : public fast::TopicDataType {
 public:
  explicit Type(const std::string& name) {
    setName(name.c_str());
    m_typeSize = largest;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    payload->encapsulation = CDR_LE;
    cdr.serialize_encapsulation();
    write(cdr, *static_cast<Message*>(data));
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    try {
      cdr.read_encapsulation();
      read(cdr, *static_cast<Message*>(data));
    } catch (const eprosima::fastcdr::exception::Exception& error) {
      std::fprintf(stderr, "%s: %s\n", getName(), error.what());
      return false;
    }
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return largest; };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

std::mutex printing;

template <class Message>
class Echo : public fast::DataReaderListener {
 public:
  Echo(std::string name, fast::DataWriter* answers) : name_(std::move(name)), answers_(answers) {}
  void on_data_available(fast::DataReader* reader) override {
    Message message;
    fast::SampleInfo info;
    while (reader->take_next_sample(&message, &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      std::string line = name_;
      show(line, message);
      {
        const std::lock_guard lock(printing);
        std::puts(line.c_str());
        std::fflush(stdout);
      }
      if (answers_ != nullptr) answers_->write(&message);
    }
  }

 private:
  std::string name_;
  fast::DataWriter* answers_;
};

class Peer {
 public:
  explicit Peer(std::uint32_t domain) {
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    fast::DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t here;
    rtps::IPLocator::setIPv4(here, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(here);
    participant_ = fast::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    publisher_ = participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
  }

  template <class Message>
  void echo(const std::string& name) {
    register_type<Message>(name);
    fast::DataWriterQos writing;
    writing.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    auto* answers =
        publisher_->create_datawriter(topic("rt/answer/" + short_name(name), name), writing);
    listen<Message>("rt/request/" + short_name(name), name, answers, false);
  }

  template <class Message>
  void listen(const std::string& topic_name, const std::string& name, fast::DataWriter* answers,
              bool latched) {
    register_type<Message>(name);
    fast::DataReaderQos reading;
    reading.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    reading.durability().kind =
        latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    auto* echo = new Echo<Message>(latched ? "latched" : short_name(name), answers);
    subscriber_->create_datareader(topic(topic_name, name), reading, echo);
  }

  static std::string short_name(const std::string& name) {
    const auto at = name.rfind(':') + 1;
    return name.substr(at, name.size() - at - 1);
  }

 private:
  template <class Message>
  void register_type(const std::string& name) {
    if (participant_->find_type(name).empty()) {
      fast::TypeSupport(new Type<Message>(name)).register_type(participant_);
    }
  }
  fast::Topic* topic(const std::string& name, const std::string& type) {
    return participant_->create_topic(name, type, fast::TOPIC_QOS_DEFAULT);
  }

  fast::DomainParticipant* participant_;
  fast::Publisher* publisher_;
  fast::Subscriber* subscriber_;
};

int main(int, char** arguments) {
  Peer peer(static_cast<std::uint32_t>(std::atoi(arguments[1])));
  peer.echo<Bool>("std_msgs::msg::dds_::Bool_");
  peer.echo<Int8>("std_msgs::msg::dds_::Int8_");
  peer.echo<Float64>("std_msgs::msg::dds_::Float64_");
  peer.echo<String>("std_msgs::msg::dds_::String_");
  peer.echo<Float64MultiArray>("std_msgs::msg::dds_::Float64MultiArray_");
  peer.echo<Twist>("geometry_msgs::msg::dds_::Twist_");
  peer.echo<TwistStamped>("geometry_msgs::msg::dds_::TwistStamped_");
  peer.echo<Odometry>("nav_msgs::msg::dds_::Odometry_");
  peer.echo<TFMessage>("tf2_msgs::msg::dds_::TFMessage_");
  peer.echo<JointState>("sensor_msgs::msg::dds_::JointState_");
  peer.echo<BatteryState>("sensor_msgs::msg::dds_::BatteryState_");
  peer.echo<JointTrajectory>("trajectory_msgs::msg::dds_::JointTrajectory_");
  peer.echo<DiagnosticArray>("diagnostic_msgs::msg::dds_::DiagnosticArray_");
  peer.listen<String>("rt/latched", "std_msgs::msg::dds_::String_", nullptr, true);
  std::puts("ready");
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  // The listeners and entities live as long as the process.
  std::fflush(stdout);
  std::_Exit(0);
}
