#include "scene/dump/raw_dump.hpp"

#include <fmt/format.h>

#include "number/error.hpp"

namespace lostbits::scene::dump {

std::vector<BinaryColumn> read_columns(const std::string& text) {
    std::vector<BinaryColumn> columns;
    std::optional<ItemType> type;
    std::uint64_t offset = 0;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        std::string word = text.substr(begin, end - begin);
        word.erase(0, word.find_first_not_of(' '));
        word.erase(word.find_last_not_of(' ') + 1);
        const auto colon = word.find(':');
        const std::string name = word.substr(0, colon);
        if (colon != std::string::npos) {
            const std::string named = word.substr(colon + 1);
            type = find_item_type(named);
            if (!type)
                throw InputError(fmt::format("--columns: {}: \"{}\" is not a type of numbers; write {}", name, named,
                                             known_item_types));
        }
        if (name.empty())
            throw InputError(
                fmt::format("--columns: a name is missing in front of \"{}\"; write ox:f32,oy,oz,…, and _ for "
                            "what is to be passed over",
                            text.substr(begin)));
        if (!type)
            throw InputError(
                fmt::format("--columns: {} has no type; write {}:f32, and every column behind it that has "
                            "none is of that type too",
                            name, name));
        columns.push_back({name, *type, offset});
        offset += type->size;
        begin = end + 1;
    }
    return columns;
}

RawDump::RawDump(const std::filesystem::path& path, const DumpOptions& options) : BinaryDump(path, options) {
    if (options.columns.empty())
        throw InputError(path.string() +
                         ": raw numbers say nothing of themselves; name them and their types with "
                         "--columns ox:f32,oy,oz,dx,dy,dz,hit:u8,t:f32");
    Lie raw{.columns = read_columns(options.columns), .begin = options.skip};
    for (const BinaryColumn& c : raw.columns) raw.record_size += c.type.size;
    if (source().size() && *source().size() < options.skip)
        throw InputError(fmt::format("{}: --skip {} is beyond its end: it has {} bytes", path.string(), options.skip,
                                     *source().size()));
    std::string passed;
    for (std::uint64_t left = options.skip; left > 0; passed.clear()) {
        const std::size_t got =
            source().read(passed, static_cast<std::size_t>(std::min<std::uint64_t>(left, 1U << 20)));
        if (got == 0) throw InputError(path.string() + ": ends before --skip is passed over");
        left -= got;
    }
    lie(std::move(raw), options, [](std::size_t, const std::string& why) { throw InputError("--columns: " + why); });
}

}  // namespace lostbits::scene::dump
