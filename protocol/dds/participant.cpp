#include "protocol/dds/participant.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>

#include "protocol/base/xml.hpp"
#include "protocol/dds/participant_impl.hpp"

namespace enamel::dds {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::uint32_t, std::weak_ptr<DomainHolder>> domains;
};

Registry& registry() {
  static Registry instance;
  return instance;
}

Result<std::shared_ptr<DomainHolder>> domain_for(const ParticipantOptions& options) {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  if (auto held = all.domains[options.domain].lock()) {
    if (held->options.tag == options.tag) return held;
    return fail(ErrorCode::kDds,
                "domain " + std::to_string(options.domain) + " is in use with tag " + held->options.tag);
  }
  auto holder = std::make_shared<DomainHolder>();
  holder->options = options;
  if (options.link || std::getenv("CYCLONEDDS_URI") == nullptr) {
    ENAMEL_TRY_ASSIGN(const std::string interface, interface_of(options.link.value_or(LinkProfile{})));
    const dds_entity_t entity = dds_create_domain(options.domain, cyclone_config(options, interface).c_str());
    if (entity < 0) return dds_fail(entity, "domain " + std::to_string(options.domain));
    holder->entity = entity;
  }
  all.domains[options.domain] = holder;
  return holder;
}

}  // namespace

// The last participant of a domain may go while another thread asks for a new one.
DomainHolder::~DomainHolder() {
  if (entity == 0) return;
  dds_delete(entity);
}

tl::unexpected<Error> dds_fail(dds_return_t rc, const std::string& what) {
  return fail(ErrorCode::kDds, what + ": " + dds_strretcode(rc));
}

// Loopback: no dependence on multicast routes or on which network the machine is in. Large datagrams, because loopback
// neither loses nor fragments them and each costs a system call. WhcHigh lets some twenty VGA bursts be unacknowledged
// before a write waits, WhcLow lets it go on when there is room again instead of when all is drained. A lost datagram
// is asked for again after NackDelay. The lease is the time in which a killed peer is noticed.
std::string cyclone_config(const ParticipantOptions& options, const std::string& interface) {
  const LinkProfile link = options.link.value_or(LinkProfile{});
  std::string peers;
  for (const std::string& peer : link.peers) peers += fmt::format(R"(<Peer Address="{}"/>)", xml_escaped(peer));
  return fmt::format(
      R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
 <General><Interfaces><NetworkInterface name="{}" multicast="{}"/></Interfaces><AllowMulticast>{}</AllowMulticast>
  <MaxMessageSize>{}B</MaxMessageSize><MaxRexmitMessageSize>1456B</MaxRexmitMessageSize><FragmentSize>{}B</FragmentSize>
 </General>
 <Discovery><Peers>{}</Peers><ParticipantIndex>auto</ParticipantIndex>
  <MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex><LeaseDuration>2s</LeaseDuration><SPDPInterval>500ms</SPDPInterval>
  <Tag>{}</Tag></Discovery>
 <Internal><SocketReceiveBufferSize min="default" max="8MB"/><NackDelay>{}ms</NackDelay>
  <HeartbeatInterval min="5ms" minsched="5ms" max="100ms">{}ms</HeartbeatInterval>
  <Watermarks><WhcHigh>{}MB</WhcHigh><WhcHighInit>{}MB</WhcHighInit><WhcLow>{}MB</WhcLow></Watermarks></Internal>
</Domain></CycloneDDS>)",
      xml_escaped(interface), link.multicast, link.multicast ? "spdp" : "false", link.message_bytes,
      link.fragment_bytes, peers, link.max_participants, xml_escaped(options.tag), link.nack_delay_ms,
      link.heartbeat_ms, link.send_window_mb, std::max(1, link.send_window_mb / 3),
      std::max(1, link.send_window_mb / 6));
}

Result<ParticipantOptions> participant_options(const LinkChoice& choice, LinkEnd end) {
  ParticipantOptions options;
  options.tag = choice.tag;
  if (choice.link.empty()) {
    if (choice.peers.empty()) return options;
    return fail(ErrorCode::kUsage, "--peer goes with --link usb, wifi or a file");
  }
  ENAMEL_TRY_ASSIGN(options.link, read_link(choice.link));
  if (!choice.peers.empty()) options.link->peers = choice.peers;
  const bool deaf = options.link->peers.empty() && !options.link->multicast;
  if (deaf && end == LinkEnd::kHost) {
    return fail(ErrorCode::kUsage, "--link " + choice.link +
                                       ": without multicast one end must be told of the other; give "
                                       "the probe's address with --peer");
  }
  return options;
}

Result<Participant> Participant::create(const ParticipantOptions& options) {
  ENAMEL_TRY_ASSIGN(auto domain, domain_for(options));
  const dds_entity_t entity = dds_create_participant(options.domain, nullptr, nullptr);
  if (entity < 0) return dds_fail(entity, "participant in domain " + std::to_string(options.domain));
  return Participant(std::make_shared<Impl>(std::move(domain), entity));
}

}  // namespace enamel::dds
