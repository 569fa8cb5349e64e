// Records that stand far behind in a file that nobody has to write.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "scene/dump/dump.hpp"

namespace lostbits::scene::test {

using dump::Chunk;
using dump::Dump;
using dump::Layout;
using dump::Records;

/// A file of which somebody else has the first 2^33 records.
class LateDump final : public Dump {
public:
    static constexpr std::uint64_t before = std::uint64_t{1} << 33;

    explicit LateDump(std::unique_ptr<Dump> rest)
        : Dump(rest->name(), {.format = rest->format()}), rest_(std::move(rest)) {}
    [[nodiscard]] const Layout& layout() const override { return rest_->layout(); }
    [[nodiscard]] std::uint64_t bytes() const override { return 0; }
    bool next(std::size_t max_records, Records& records) override {
        const bool there = rest_->next(max_records, records);
        records.first += before;
        return there;
    }
    [[nodiscard]] Chunk decode(const Records& records) const override { return rest_->decode(records); }

private:
    std::unique_ptr<Dump> rest_;
};

}  // namespace lostbits::scene::test
