#include "protocol/dds/participant.hpp"

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
  if (std::getenv("CYCLONEDDS_URI") == nullptr) {
    const dds_entity_t entity = dds_create_domain(options.domain, cyclone_config(options).c_str());
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

// Loopback, unicast only: no dependence on multicast routes or on which network the machine is in. Large datagrams,
// because loopback neither loses nor fragments them and each costs a system call. WhcHigh lets some twenty VGA bursts
// be unacknowledged before a write waits, WhcLow lets it go on when there is room again instead of when all is drained.
// A lost datagram (full socket buffer) is asked for again after NackDelay. The lease is the time in which a killed peer
// is noticed.
std::string cyclone_config(const ParticipantOptions& options) {
  return R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
 <General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast>
  <MaxMessageSize>65500B</MaxMessageSize><FragmentSize>65000B</FragmentSize></General>
 <Discovery><Peers><Peer Address="127.0.0.1"/></Peers><ParticipantIndex>auto</ParticipantIndex>
  <MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><LeaseDuration>2s</LeaseDuration><SPDPInterval>500ms</SPDPInterval>
  <Tag>)" +
         xml_escaped(options.tag) + R"(</Tag></Discovery>
 <Internal><SocketReceiveBufferSize min="default" max="8MB"/><NackDelay>5ms</NackDelay>
  <HeartbeatInterval min="5ms" minsched="5ms" max="100ms">20ms</HeartbeatInterval>
  <Watermarks><WhcHigh>24MB</WhcHigh><WhcHighInit>8MB</WhcHighInit><WhcLow>4MB</WhcLow></Watermarks></Internal>
</Domain></CycloneDDS>)";
}

Result<Participant> Participant::create(const ParticipantOptions& options) {
  ENAMEL_TRY_ASSIGN(auto domain, domain_for(options));
  const dds_entity_t entity = dds_create_participant(options.domain, nullptr, nullptr);
  if (entity < 0) return dds_fail(entity, "participant in domain " + std::to_string(options.domain));
  return Participant(std::make_shared<Impl>(std::move(domain), entity));
}

}  // namespace enamel::dds
