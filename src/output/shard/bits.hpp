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

/// Writes values as bits: `writer(a, b, c)` writes one after the other. For a struct it calls `fields(writer, struct)`,
/// from the namespace of the struct or from this one. That function lists the fields, for writing and for reading. A
/// list is preceded by its size.
class BitWriter {
public:
    template <class... T>
    void operator()(const T&... values) {
        (write(values), ...);
    }
    [[nodiscard]] std::string release() { return std::move(bytes_); }

private:
    template <class T>
    void write(const T& x) {
        if constexpr (PlainBits<T>) bytes_.append(reinterpret_cast<const char*>(&x), sizeof x);
        else fields(*this, const_cast<T&>(x));  // BitReader changes it, BitWriter does not
    }
    template <class T>
    void write_list(const T* begin, std::size_t size) {
        if constexpr (PlainBits<T>) bytes_.append(reinterpret_cast<const char*>(begin), size * sizeof(T));
        else
            for (std::size_t i = 0; i < size; ++i) write(begin[i]);
    }
    void write(const std::string& x) {
        write(std::uint64_t{x.size()});
        bytes_ += x;
    }
    template <class T>
    void write(const std::vector<T>& x) {
        write(std::uint64_t{x.size()});
        write_list(x.data(), x.size());
    }
    template <class T, std::size_t n>
    void write(const std::array<T, n>& x) {
        write_list(x.data(), n);
    }
    /// Writes a pointer or an optional as a bool, followed by the value if there is one.
    template <class T>
    requires requires(const T& x) { *x, static_cast<bool>(x); }
    void write(const T& x) {
        write(static_cast<bool>(x));
        if (x) write(*x);
    }

    std::string bytes_;
};

/// Reads what a `BitWriter` wrote. Throws std::out_of_range if the bits end too early.
class BitReader {
public:
    explicit BitReader(std::string bytes) : bytes_(std::move(bytes)) {}

    template <class... T>
    void operator()(T&... values) {
        (read(values), ...);
    }
    [[nodiscard]] bool is_at_end() const { return position_ == bytes_.size(); }

private:
    const char* take_bytes(std::uint64_t size) {
        if (size > bytes_.size() - position_) throw std::out_of_range("the bits of a shard end too early");
        const char* const begin = bytes_.data() + position_;
        position_ += size;
        return begin;
    }
    template <class T>
    void read(T& x) {
        if constexpr (PlainBits<T>) std::memcpy(&x, take_bytes(sizeof x), sizeof x);
        else fields(*this, x);
    }
    /// Refuses every byte but 0 and 1: another value in a bool is undefined behaviour.
    void read(bool& x) {
        const char byte = *take_bytes(1);
        if (byte != 0 && byte != 1) throw std::out_of_range("a bool of a shard is neither 0 nor 1");
        x = byte == 1;
    }
    std::uint64_t read_size() {
        std::uint64_t count = 0;
        read(count);
        if (count > bytes_.size() - position_) throw std::out_of_range("a list of a shard is longer than what follows");
        return count;
    }
    template <class T>
    void read_list(T* begin, std::size_t n) {
        if constexpr (PlainBits<T>) {
            const char* const source = take_bytes(n * sizeof(T));
            if (n > 0) std::memcpy(begin, source, n * sizeof(T));
        } else {
            for (std::size_t i = 0; i < n; ++i) read(begin[i]);
        }
    }
    void read(std::string& x) {
        const std::uint64_t n = read_size();
        x.assign(take_bytes(n), n);
    }
    /// Takes no more memory than the rest of the file can fill, whatever size the list claims.
    template <class T>
    void read(std::vector<T>& x) {
        const std::uint64_t n = read_size();
        x.clear();
        if constexpr (PlainBits<T>) {
            if (n > (bytes_.size() - position_) / sizeof(T))
                throw std::out_of_range("a list of a shard is longer than what follows");
            x.resize(n);
            read_list(x.data(), n);
        } else {
            for (std::uint64_t i = 0; i < n; ++i) read(x.emplace_back());
        }
    }
    template <class T, std::size_t n>
    void read(std::array<T, n>& x) {
        read_list(x.data(), n);
    }
    bool read_flag() {
        bool flag = false;
        read(flag);
        return flag;
    }
    template <class T>
    void read(std::optional<T>& x) {
        x.reset();
        if (read_flag()) read(x.emplace());
    }
    template <class T>
    void read(std::unique_ptr<T>& x) {
        x = read_flag() ? std::make_unique<T>() : nullptr;
        if (x) read(*x);
    }
    template <class T>
    void read(std::shared_ptr<const T>& x) {
        x.reset();
        if (!read_flag()) return;
        auto value = std::make_shared<T>();
        read(*value);
        x = std::move(value);
    }

    std::string bytes_;
    std::size_t position_ = 0;
};

}  // namespace lostbits::output::shard
