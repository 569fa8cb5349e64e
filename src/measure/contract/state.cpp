#include "intersect/doors/guard.hpp"
#include "measure/contract/probe.hpp"

namespace lostbits::measure::contract {

Observation observe_state(const intersect::doors::ForeignForm& form) {
    const std::string& loaded = form.contract.state;
    const std::string where =
        loaded.empty() ? "" : "loading its library leaves the processor with " + loaded + ", and it is run so";
    const std::string noted = intersect::doors::change_noted(intersect::doors::name_in_messages(form));
    if (!noted.empty()) return {"state", Observation::Verdict::broken, noted + (where.empty() ? "" : "; " + where)};
    if (!where.empty()) return {"state", Observation::Verdict::told, where + ", as its users run it; nothing else is"};
    return {"state", Observation::Verdict::kept, "the processor rounds to nearest in it and keeps subnormal numbers"};
}

}  // namespace lostbits::measure::contract
