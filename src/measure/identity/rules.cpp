#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

void RewriteFinder::offer(std::vector<std::pair<NodeId, NodeId>> replaced) {
    std::erase_if(replaced, [](const auto& r) { return r.first == r.second; });
    if (!replaced.empty()) found.push_back({rule, std::move(replaced)});
}

void RewriteFinder::offer_each(const std::vector<std::pair<NodeId, NodeId>>& replaced) {
    if (replaced.size() > 1) offer(replaced);
    for (const auto& one : replaced) offer({one});
}

std::vector<Rewrite> rewrites_of(Terms& terms, const TapeOutputs& outputs, std::optional<Triple> unit) {
    RewriteFinder places(terms, outputs, unit);
    for (const Rule& rule : rules) {
        places.rule = &rule;
        rule.find(places);
    }
    return std::move(places.found);
}

}  // namespace lostbits::measure::identity
