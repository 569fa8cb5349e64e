// Several files of rays as one, in their order.
#include "number/error.hpp"
#include "scene/dump/dump.hpp"

namespace lostbits::scene::dump {

namespace {

std::string names_of(const std::vector<std::unique_ptr<Dump>>& files) {
    std::string names;
    for (const auto& file : files) names += (names.empty() ? "" : ", ") + file->name();
    return names;
}

/// Whether a solid, an answer and a format are there in both alike.
bool are_alike(const Dump& a, const Dump& b) {
    return a.layout().solid() == b.layout().solid() && a.layout().has_matrix() == b.layout().has_matrix() &&
           a.layout().has_answers() == b.layout().has_answers() &&
           a.layout().decides_only() == b.layout().decides_only() && a.format() == b.format();
}

class JoinedDump final : public Dump {
public:
    explicit JoinedDump(std::vector<std::unique_ptr<Dump>> files)
        : Dump(names_of(files), {.format = files.front()->format()}), files_(std::move(files)), first_(files_.size()) {
        for (const auto& file : files_) {
            if (!are_alike(*files_.front(), *file))
                throw InputError(file->name() + ": its columns or its format are not those of " +
                                 files_.front()->name() +
                                 "; files that are taken together all have solids or none, answers or none, and one "
                                 "format; try each by itself");
        }
    }

    [[nodiscard]] const Layout& layout() const override { return files_.front()->layout(); }
    [[nodiscard]] std::uint64_t bytes() const override {
        std::uint64_t all = 0;
        for (const auto& file : files_) {
            if (file->bytes() == 0) return 0;
            all += file->bytes();
        }
        return all;
    }

    bool next(std::size_t most, Records& records) override {
        for (; file_ < files_.size(); ++file_) {
            if (files_[file_]->next(most, records)) {
                records.file = file_;
                count_ += records.count;
                return true;
            }
            if (count_ == first_[file_])
                throw InputError(files_[file_]->name() +
                                 ": has no rays; write a record for each behind what stands in front");
            if (file_ + 1 < files_.size()) first_[file_ + 1] = count_;
        }
        return false;
    }

    void put_under_matrices(const Solid<double>& solid) override {
        for (const auto& file : files_) file->put_under_matrices(solid);
    }
    [[nodiscard]] Chunk decode(const Records& records) const override {
        Chunk chunk = files_[records.file]->decode(records);
        chunk.first += first_[records.file];
        return chunk;
    }

private:
    std::vector<std::unique_ptr<Dump>> files_;
    std::vector<std::uint64_t> first_;  ///< of each file: the rays before it; written before any of its records is read
    std::size_t file_ = 0;
    std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<Dump> join_dumps(std::vector<std::unique_ptr<Dump>> files) {
    if (files.size() == 1) return std::move(files.front());
    return std::make_unique<JoinedDump>(std::move(files));
}

}  // namespace lostbits::scene::dump
