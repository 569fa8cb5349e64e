// The other end of a pipe: forms of a library, answered from a process of their own.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string_view>

#include "intersect/doors/foreign_batch.hpp"
#include "intersect/doors/pipe.hpp"
#include "intersect/doors/pipe_header.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {
namespace {

bool read_all(int from, void* to, std::size_t bytes) {
    auto* place = static_cast<char*>(to);
    while (bytes > 0) {
        const ssize_t got = read(from, place, bytes);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        place += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

/// So many bytes, for which room is made as they come: a request may claim any number of rays.
bool read_column(int from, std::vector<std::byte>& column, std::size_t bytes) {
    constexpr std::size_t piece = 1 << 20;
    for (std::size_t done = 0; done < bytes;) {
        if (done >= column.size()) column.resize(std::min(bytes, done + piece));
        const std::size_t more = std::min(bytes, column.size()) - done;
        if (!read_all(from, column.data() + done, more)) return false;
        done += more;
    }
    column.resize(bytes);
    return true;
}

bool write_all(int to, const void* from, std::size_t bytes) {
    const auto* place = static_cast<const char*>(from);
    while (bytes > 0) {
        const ssize_t put = write(to, place, bytes);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        place += put;
        bytes -= static_cast<std::size_t>(put);
    }
    return true;
}

bool refuse(int output, std::string_view why) {
    PipeAnswer answer;
    answer.error = static_cast<std::uint32_t>(why.size());
    return write_all(output, &answer, sizeof answer) && write_all(output, why.data(), why.size());
}

/// The numbers of a batch, as bytes: they are handed on as they came.
struct Room {
    std::vector<std::byte> rays, ends, solids;
    std::vector<double> near_far;  ///< or twice as many floats
    std::vector<std::uint8_t> hit;
};

bool answer_one(const ForeignForm& form, const PipeRequest& request, Room& room, int input, int output) {
    const std::size_t width = static_cast<std::size_t>(form.contract.bits) / 8, n = request.rays;
    const std::size_t numbers = number_names(form.contract.shape).size();
    if (!read_column(input, room.rays, 6 * n * width) || !read_column(input, room.ends, request.ends * width) ||
        !read_column(input, room.solids, request.solids * numbers * width))
        return false;
    room.near_far.resize(2 * n);
    room.hit.resize(n);
    if (width == sizeof(double)) mark_unwritten<double>(room.near_far, room.hit);
    else mark_unwritten<float>({reinterpret_cast<float*>(room.near_far.data()), 2 * n}, room.hit);
    try {
        form.answer({.size = n,
                     .rays = room.rays.data(),
                     .ends = room.ends.empty() ? nullptr : room.ends.data(),
                     .solids = room.solids.data(),
                     .solid_stride = request.solids == 1 ? 0 : numbers,
                     .near_far = room.near_far.data(),
                     .hit = room.hit.data(),
                     .own = nullptr});
    } catch (const std::exception& error) {
        return refuse(output, error.what());
    }
    const PipeAnswer fine;
    return write_all(output, &fine, sizeof fine) && write_all(output, room.near_far.data(), 2 * n * width) &&
           write_all(output, room.hit.data(), n);
}

}  // namespace

std::string refusal_of(const Error& error) {
    const char* const key = error.code() == Exit::bad_input ? "error=" : "missing=";
    constexpr std::size_t longest = 4000;  // of a line of the header
    std::string header = std::string(pipe_version) + "\n";
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) header += key + line.substr(0, longest) + "\n";
    return header + "\n";
}

bool serve_pipe(const std::vector<ForeignForm>& forms, int input, int output) {
    std::vector<Contract> contracts;
    for (const ForeignForm& form : forms) contracts.push_back(form.contract);
    const std::string header = pipe_header_of(contracts);
    if (!write_all(output, header.data(), header.size())) return true;
    Room room;
    for (PipeRequest request; read_all(input, &request, sizeof request);) {
        if (std::memcmp(request.magic, PipeRequest{}.magic, sizeof request.magic) != 0) return false;
        if (request.form >= forms.size() || (request.solids != 1 && request.solids != request.rays) ||
            (request.ends != 0 && request.ends != request.rays))
            return false;
        if (!answer_one(forms[request.form], request, room, input, output)) return true;
    }
    return true;
}

}  // namespace lostbits::intersect::doors
