// Records that stand far behind in a file that nobody has to write.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "scene/ray_file/ray_file.hpp"

namespace lostbits::scene::test {

using ray_file::Chunk;
using ray_file::Layout;
using ray_file::RayFile;
using ray_file::Records;

/// A file of which somebody else has the first 2^33 records.
class LateRayFile final : public RayFile {
public:
    static constexpr std::uint64_t before = std::uint64_t{1} << 33;

    explicit LateRayFile(std::unique_ptr<RayFile> rest)
        : RayFile(rest->name(), {.format = rest->format()}), rest_(std::move(rest)) {}
    [[nodiscard]] const Layout& layout() const override { return rest_->layout(); }
    [[nodiscard]] std::uint64_t bytes() const override { return 0; }
    bool next(std::size_t max_records, Records& records) override {
        const bool there = rest_->next(max_records, records);
        records.first += before;
        return there;
    }
    [[nodiscard]] Chunk decode(const Records& records) const override { return rest_->decode(records); }

private:
    std::unique_ptr<RayFile> rest_;
};

}  // namespace lostbits::scene::test
