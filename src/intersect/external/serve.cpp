// The serving end of a pipe: answers batches with the forms of a library from a separate process.
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

bool read_all(int descriptor, void* buffer, std::size_t byte_count) {
    auto* next_byte = static_cast<char*>(buffer);
    for (int poll_count = 0; byte_count > 0;) {
        const ssize_t received = read(descriptor, next_byte, byte_count);
        if (received < 0 && errno == EINTR) continue;
        if (received < 0 && errno == EAGAIN) {
            pollfd polled_input{descriptor, POLLIN, 0};
            if (++poll_count < process::polls_before_sleep) sched_yield();
            else poll(&polled_input, 1, -1);
            continue;
        }
        if (received <= 0) return false;
        next_byte += received;
        byte_count -= static_cast<std::size_t>(received);
    }
    return true;
}

/// Reads this many bytes. The buffer grows as the bytes arrive, since a request may claim any number of rays.
bool read_column(int descriptor, std::vector<std::byte>& column, std::size_t byte_count) {
    constexpr std::size_t piece_size = 1 << 20;
    for (std::size_t bytes_read = 0; bytes_read < byte_count;) {
        if (bytes_read >= column.size()) column.resize(std::min(byte_count, bytes_read + piece_size));
        const std::size_t bytes_to_read = std::min(byte_count, column.size()) - bytes_read;
        if (!read_all(descriptor, column.data() + bytes_read, bytes_to_read)) return false;
        bytes_read += bytes_to_read;
    }
    column.resize(byte_count);
    return true;
}

bool write_all(int descriptor, const void* buffer, std::size_t byte_count) {
    const auto* next_byte = static_cast<const char*>(buffer);
    while (byte_count > 0) {
        const ssize_t written = write(descriptor, next_byte, byte_count);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        next_byte += written;
        byte_count -= static_cast<std::size_t>(written);
    }
    return true;
}

/// The columns of a batch as they arrived; null for a column that the batch does not have.
using BatchColumns = std::array<std::byte*, BatchColumn::count>;

std::uint8_t* hits_in(const BatchColumns& columns) {
    return reinterpret_cast<std::uint8_t*>(columns[BatchColumn::hit]);
}

template <class S>
void mark_unwritten_in(const BatchColumns& columns, std::size_t ray_count) {
    mark_unwritten<S>({reinterpret_cast<S*>(columns[BatchColumn::near_far]), 2 * ray_count},
                      {hits_in(columns), ray_count});
}

/// Writes the answer into the columns. Returns the error text if the form fails, else an empty text.
std::string answer_in_place(const ForeignForm& form, const PipeRequest& request, const BatchColumns& columns) {
    if (form.contract.bits == 64) mark_unwritten_in<double>(columns, request.ray_count);
    else mark_unwritten_in<float>(columns, request.ray_count);
    try {
        form.answer({.size = request.ray_count,
                     .rays = columns[BatchColumn::rays],
                     .ends = columns[BatchColumn::ends],
                     .primitives = columns[BatchColumn::primitives],
                     .primitive_stride = request.primitive_count == 1 ? 0 : row_of(form.contract.shape).number_count,
                     .near_far = columns[BatchColumn::near_far],
                     .hit = hits_in(columns),
                     .own = nullptr,
                     .starts = columns[BatchColumn::starts]});
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

bool is_valid_request(const PipeRequest& request, const std::vector<ForeignForm>& forms) {
    return std::memcmp(request.magic, PipeRequest{}.magic, sizeof request.magic) == 0 &&
           request.form_index < forms.size() &&
           (request.primitive_count == 1 || request.primitive_count == request.ray_count) &&
           (request.end_count == 0 || request.end_count == request.ray_count);
}

/// The memory of the columns: shared with the client, or our own. The client is the process that asks for answers.
struct ColumnMemory {
    std::optional<process::SharedMemory> shared;
    std::array<std::vector<std::byte>, BatchColumn::count> columns;
};

/// Returns the columns of a batch. Reads them from the input if they are not in shared memory. Empty if the input ends
/// before all columns have arrived, or if there is no memory.
std::optional<BatchColumns> read_batch(int input, const PipeRequest& request, const Contract& contract,
                                       ColumnMemory& buffers) {
    const ColumnBytes bytes = column_bytes(request, contract);
    const auto offsets = column_offsets(bytes);
    std::byte* const memory = buffers.shared ? buffers.shared->grow_to(offsets.back()) : nullptr;
    if (buffers.shared && memory == nullptr) return std::nullopt;

    BatchColumns columns{};
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!buffers.shared && k < BatchColumn::request_columns && !read_column(input, buffers.columns[k], bytes[k]))
            return std::nullopt;
        if (!buffers.shared && k >= BatchColumn::request_columns) buffers.columns[k].resize(bytes[k]);
        if (bytes[k] > 0) columns[k] = buffers.shared ? memory + offsets[k] : buffers.columns[k].data();
    }
    return columns;
}

/// Writes the answer, or the error text in its place. Returns false if the output accepts no more bytes.
bool write_answer(int output, const std::string& error_text, const ForeignForm& form, const ColumnMemory& buffers) {
    PipeAnswer answer;
    answer.error_bytes = static_cast<std::uint32_t>(error_text.size());
    if (buffers.shared && !find_noted_change(name_in_messages(form)).empty()) answer.error_bytes |= state_changed_bit;
    if (!write_all(output, &answer, sizeof answer)) return false;
    if (!error_text.empty()) return write_all(output, error_text.data(), error_text.size());
    const auto write_column = [&](std::size_t k) {
        return write_all(output, buffers.columns[k].data(), buffers.columns[k].size());
    };
    return buffers.shared || (write_column(BatchColumn::near_far) && write_column(BatchColumn::hit));
}

/// True if the client has closed its end, as it does when its run is interrupted.
bool client_has_ended(int input) {
    pollfd polled_input{input, POLLIN, 0};
    char byte = 0;
    return poll(&polled_input, 1, 0) > 0 && ((polled_input.revents & POLLHUP) != 0 || read(input, &byte, 1) == 0);
}

/// Throws the error of a failed write, unless the client has ended and so expects no answer.
void require_client_ended(int input) {
    const int write_error = errno;
    if (!client_has_ended(input))
        throw EnvironmentError(std::string("cannot write to the process that asks for answers: ") +
                               std::strerror(write_error));
}

}  // namespace

std::string error_lines_of(const Error& error) {
    const char* const key = error.status() == ExitStatus::bad_input ? "error=" : "missing=";
    constexpr std::size_t max_line_bytes = 4000;  // bytes in a line of the header
    std::string header = std::string(pipe_version) + "\n";
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) header += key + line.substr(0, max_line_bytes) + "\n";
    return header + "\n";
}

bool serve_pipe(const std::vector<ForeignForm>& forms, int input, int output) {
    std::vector<Contract> contracts;
    for (const ForeignForm& form : forms) contracts.push_back(form.contract);
    const std::string header = make_pipe_header(contracts);
    signal(SIGPIPE, SIG_IGN);  // a failed write returns an error instead of ending the process
    if (!write_all(output, header.data(), header.size())) {
        require_client_ended(input);
        return true;
    }

    ColumnMemory buffers;
    for (PipeRequest request; read_all(input, &request, sizeof request);) {
        if (std::memcmp(request.magic, shared_memory_magic, sizeof request.magic) == 0) {
            buffers.shared.emplace(process::SharedMemory::inherited);
            fcntl(input, F_SETFL, fcntl(input, F_GETFL) | O_NONBLOCK);  // no other process reads from this end
            continue;
        }

        if (!is_valid_request(request, forms)) return false;
        const ForeignForm& form = forms[request.form_index];
        const std::optional<BatchColumns> columns = read_batch(input, request, form.contract, buffers);
        if (!columns) return true;
        if (!write_answer(output, answer_in_place(form, request, *columns), form, buffers)) {
            require_client_ended(input);
            return true;
        }
    }
    return true;
}

}  // namespace lostbits::intersect::external
