// Writes values as exact bits and reads them back. One list of fields serves both directions.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lostbits::output::shard {

static_assert(std::endian::native == std::endian::little, "the files of shards are little-endian on every machine");

/// Types that are copied byte for byte: numbers, enumerations, and structs of bytes without padding.
template <class T>
concept PlainBits = std::is_arithmetic_v<T> || std::is_enum_v<T> ||
    (std::is_trivially_copyable_v<T>&& std::has_unique_object_representations_v<T> && alignof(T) == 1);

/// Writes values: `out(a, b, c)` writes one after the other. For a struct it calls `fields(out, struct)`, from the
/// namespace of the struct or from this one, which lists the fields once for both directions. A list is preceded by its
/// size.
class BitWriter {
public:
    template <class... T>
    void operator()(const T&... values) {
        (put(values), ...);
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    template <class T>
    void put(const T& x) {
        if constexpr (PlainBits<T>) bytes_.append(reinterpret_cast<const char*>(&x), sizeof x);
        else fields(*this, const_cast<T&>(x));  // BitReader changes it, BitWriter does not
    }
    template <class T>
    void put_list(const T* begin, std::size_t size) {
        if constexpr (PlainBits<T>) bytes_.append(reinterpret_cast<const char*>(begin), size * sizeof(T));
        else
            for (std::size_t i = 0; i < size; ++i) put(begin[i]);
    }
    void put(const std::string& x) {
        put(std::uint64_t{x.size()});
        bytes_ += x;
    }
    template <class T>
    void put(const std::vector<T>& x) {
        put(std::uint64_t{x.size()});
        put_list(x.data(), x.size());
    }
    template <class T, std::size_t n>
    void put(const std::array<T, n>& x) {
        put_list(x.data(), n);
    }
    /// Pointers and optionals: a bool, and the value if there is one.
    template <class T>
    requires requires(const T& x) { *x, static_cast<bool>(x); }
    void put(const T& x) {
        put(static_cast<bool>(x));
        if (x) put(*x);
    }

    std::string bytes_;
};

/// Reads what a `BitWriter` wrote. Throws std::out_of_range if the bits end too early.
class BitReader {
public:
    explicit BitReader(std::string bytes) : bytes_(std::move(bytes)) {}

    template <class... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }

private:
    const char* take(std::uint64_t size) {
        if (size > bytes_.size() - at_) throw std::out_of_range("the bits of a shard end too early");
        const char* const from = bytes_.data() + at_;
        at_ += size;
        return from;
    }
    template <class T>
    void get(T& x) {
        if constexpr (PlainBits<T>) std::memcpy(&x, take(sizeof x), sizeof x);
        else fields(*this, x);
    }
    /// Refuses every byte but 0 and 1: another value in a bool is undefined behaviour.
    void get(bool& x) {
        const char byte = *take(1);
        if (byte != 0 && byte != 1) throw std::out_of_range("a bool of a shard is neither yes nor no");
        x = byte == 1;
    }
    std::uint64_t size() {
        std::uint64_t n = 0;
        get(n);
        if (n > bytes_.size() - at_) throw std::out_of_range("a list of a shard is longer than what follows");
        return n;
    }
    template <class T>
    void get_list(T* begin, std::size_t n) {
        if constexpr (PlainBits<T>) {
            const char* const from = take(n * sizeof(T));
            if (n > 0) std::memcpy(begin, from, n * sizeof(T));
        } else {
            for (std::size_t i = 0; i < n; ++i) get(begin[i]);
        }
    }
    void get(std::string& x) {
        const std::uint64_t n = size();
        x.assign(take(n), n);
    }
    /// Takes no more memory than the rest of the file can fill, whatever size the list claims.
    template <class T>
    void get(std::vector<T>& x) {
        const std::uint64_t n = size();
        x.clear();
        if constexpr (PlainBits<T>) {
            if (n > (bytes_.size() - at_) / sizeof(T))
                throw std::out_of_range("a list of a shard is longer than what follows");
            x.resize(n);
            get_list(x.data(), n);
        } else {
            for (std::uint64_t i = 0; i < n; ++i) get(x.emplace_back());
        }
    }
    template <class T, std::size_t n>
    void get(std::array<T, n>& x) {
        get_list(x.data(), n);
    }
    bool is_there() {
        bool there = false;
        get(there);
        return there;
    }
    template <class T>
    void get(std::optional<T>& x) {
        x.reset();
        if (is_there()) get(x.emplace());
    }
    template <class T>
    void get(std::unique_ptr<T>& x) {
        x = is_there() ? std::make_unique<T>() : nullptr;
        if (x) get(*x);
    }
    template <class T>
    void get(std::shared_ptr<const T>& x) {
        x.reset();
        if (!is_there()) return;
        auto made = std::make_shared<T>();
        get(*made);
        x = std::move(made);
    }

    std::string bytes_;
    std::size_t at_ = 0;
};

}  // namespace lostbits::output::shard
