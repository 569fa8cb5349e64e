// The serving end of a pipe: the forms of a library answer from a process of their own.
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <sstream>

#include "intersect/external/foreign_batch.hpp"
#include "intersect/external/guard.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/external/pipe_header.hpp"
#include "intersect/process/child.hpp"
#include "intersect/process/shared_memory.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

bool read_all(int from, void* to, std::size_t bytes) {
    auto* place = static_cast<char*>(to);
    for (int look = 0; bytes > 0;) {
        const ssize_t got = read(from, place, bytes);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && errno == EAGAIN) {
            pollfd end{from, POLLIN, 0};
            if (++look < process::looks_before_sleep) sched_yield();
            else poll(&end, 1, -1);
            continue;
        }
        if (got <= 0) return false;
        place += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

/// Reads this many bytes. The buffer grows as they arrive, since a request may claim any number of rays.
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

/// The columns of a batch, passed on as they arrived; null for a column that the batch does not have.
using BatchColumns = std::array<std::byte*, BatchColumn::count>;

std::uint8_t* hits_in(const BatchColumns& columns) {
    return reinterpret_cast<std::uint8_t*>(columns[BatchColumn::hit]);
}

template <class S>
void mark_unwritten_in(const BatchColumns& columns, std::size_t rays) {
    mark_unwritten<S>({reinterpret_cast<S*>(columns[BatchColumn::near_far]), 2 * rays}, {hits_in(columns), rays});
}

/// Writes the answer into the columns. Returns the error text if the form fails, else an empty text.
std::string answer_in_place(const ForeignForm& form, const PipeRequest& request, const BatchColumns& columns) {
    if (form.contract.bits == 64) mark_unwritten_in<double>(columns, request.rays);
    else mark_unwritten_in<float>(columns, request.rays);
    try {
        form.answer({.size = request.rays,
                     .rays = columns[BatchColumn::rays],
                     .ends = columns[BatchColumn::ends],
                     .primitives = columns[BatchColumn::primitives],
                     .primitive_stride = request.primitives == 1 ? 0 : row_of(form.contract.shape).numbers,
                     .near_far = columns[BatchColumn::near_far],
                     .hit = hits_in(columns),
                     .own = nullptr,
                     .starts = columns[BatchColumn::starts]});
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

bool is_for(const PipeRequest& request, const std::vector<ForeignForm>& forms) {
    return std::memcmp(request.magic, PipeRequest{}.magic, sizeof request.magic) == 0 && request.form < forms.size() &&
           (request.primitives == 1 || request.primitives == request.rays) &&
           (request.ends == 0 || request.ends == request.rays);
}

/// The memory of the columns: shared with the process that asks, or our own.
struct ColumnMemory {
    std::optional<process::SharedMemory> shared;
    std::array<std::vector<std::byte>, BatchColumn::count> columns;
};

/// The columns of a batch; if they are not in shared memory, reads them from the input. Nothing if the input ends
/// before all of them have arrived, or if there is no memory.
std::optional<BatchColumns> take_batch(int input, const PipeRequest& request, const Contract& contract,
                                       ColumnMemory& buffers) {
    const ColumnBytes bytes = column_bytes(request, contract);
    const auto at = places_of(bytes);
    std::byte* const memory = buffers.shared ? buffers.shared->with_bytes(at.back()) : nullptr;
    if (buffers.shared && memory == nullptr) return std::nullopt;
    BatchColumns columns{};
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!buffers.shared && k < BatchColumn::asked && !read_column(input, buffers.columns[k], bytes[k]))
            return std::nullopt;
        if (!buffers.shared && k >= BatchColumn::asked) buffers.columns[k].resize(bytes[k]);
        if (bytes[k] > 0) columns[k] = buffers.shared ? memory + at[k] : buffers.columns[k].data();
    }
    return columns;
}

/// Writes the answer, or the error text in its place. False if the output takes no more bytes.
bool give_answer(int output, const std::string& refusal, const ForeignForm& form, const ColumnMemory& buffers) {
    PipeAnswer answer;
    answer.error_bytes = static_cast<std::uint32_t>(refusal.size());
    if (buffers.shared && !change_noted(name_in_messages(form)).empty()) answer.error_bytes |= changes_state;
    if (!write_all(output, &answer, sizeof answer)) return false;
    if (!refusal.empty()) return write_all(output, refusal.data(), refusal.size());
    const auto write_column = [&](std::size_t k) {
        return write_all(output, buffers.columns[k].data(), buffers.columns[k].size());
    };
    return buffers.shared || (write_column(BatchColumn::near_far) && write_column(BatchColumn::hit));
}

/// True if the process that asks has closed its end, as it does when its run is interrupted.
bool has_ended(int input) {
    pollfd end{input, POLLIN, 0};
    char byte = 0;
    return poll(&end, 1, 0) > 0 && ((end.revents & POLLHUP) != 0 || read(input, &byte, 1) == 0);
}

/// Throws the error of a failed write, unless the process that asks has ended: then nobody waits for the answer.
void require_client(int input) {
    const int error = errno;
    if (!has_ended(input))
        throw EnvironmentError(std::string("cannot write to the process that asks for answers: ") +
                               std::strerror(error));
}

}  // namespace

std::string refusal_of(const Error& error) {
    const char* const key = error.code() == Exit::bad_input ? "error=" : "missing=";
    constexpr std::size_t longest = 4000;  // bytes in a line of the header
    std::string header = std::string(pipe_version) + "\n";
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) header += key + line.substr(0, longest) + "\n";
    return header + "\n";
}

bool serve_pipe(const std::vector<ForeignForm>& forms, int input, int output) {
    std::vector<Contract> contracts;
    for (const ForeignForm& form : forms) contracts.push_back(form.contract);
    const std::string header = pipe_header_of(contracts);
    signal(SIGPIPE, SIG_IGN);  // a failed write returns an error instead of ending the process
    if (!write_all(output, header.data(), header.size())) return require_client(input), true;
    ColumnMemory buffers;
    for (PipeRequest request; read_all(input, &request, sizeof request);) {
        if (std::memcmp(request.magic, shares_memory, sizeof request.magic) == 0) {
            buffers.shared.emplace(process::SharedMemory::inherited);
            fcntl(input, F_SETFL, fcntl(input, F_GETFL) | O_NONBLOCK);  // no other process reads from this end
            continue;
        }
        if (!is_for(request, forms)) return false;
        const ForeignForm& form = forms[request.form];
        const std::optional<BatchColumns> columns = take_batch(input, request, form.contract, buffers);
        if (!columns) return true;
        if (!give_answer(output, answer_in_place(form, request, *columns), form, buffers))
            return require_client(input), true;
    }
    return true;
}

}  // namespace lostbits::intersect::external
