#include "intersect/external/pipe.hpp"

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>

#include "intersect/external/guard.hpp"
#include "intersect/external/pipe_header.hpp"
#include "intersect/process/child.hpp"
#include "intersect/process/shared_memory.hpp"

namespace lostbits::intersect::external {

static_assert(std::endian::native == std::endian::little, "numbers go through pipes as they lie in memory");

namespace {

using process::ChildProcess;
using process::SharedMemory;

std::vector<Contract> read_contracts(ChildProcess& child, const PipeOptions& options) {
    return read_greeting({.next_line = [&child] { return child.read_line(); },
                          .fail = [&child](const std::string& problem) { child.fail(problem); }},
                         options);
}

/// Advice for the author of the program. A process of this program needs none: the author of a shader has no say in how
/// it reads and writes.
std::string author_advice(const PipeOptions& options) {
    return options.is_lostbits ? "" : "it must read a whole batch, answer it and flush its output";
}

template <class T>
std::span<std::byte> bytes_of(T& value) {
    return std::as_writable_bytes(std::span(&value, 1));
}

/// A process that answers, and, if it is a process of this program, the memory that it shares with this process.
struct AnsweringProcess {
    AnsweringProcess(const std::string& command, const PipeOptions& options)
        : memory(options.is_lostbits ? std::make_unique<SharedMemory>() : nullptr),
          child(command, {options.message_prefix, author_advice(options), options.seconds,
                          memory ? memory->descriptor() : -1, options.stop}),
          contracts(read_contracts(child, options)) {
        if (memory && memory->descriptor() < 0) memory.reset();
        if (!memory) return;
        PipeRequest memory_request;
        std::memcpy(memory_request.magic, shared_memory_magic, sizeof memory_request.magic);
        child.exchange(bytes_of(memory_request), {});
    }

    std::unique_ptr<SharedMemory> memory;
    ChildProcess child;
    std::vector<Contract> contracts;
};

/// The processes of one command: one for each thread that sends batches at the same time, up to the limit of the
/// options.
class Pool {
public:
    Pool(std::string command, const PipeOptions& options) : command_(std::move(command)), options_(options) {
        free_.push_back(std::make_unique<AnsweringProcess>(command_, options_));
        contracts_ = free_.back()->contracts;
        running_ = 1;
        const auto needs_one_thread = [](const Contract& contract) { return (contract.flags & LB_ONE_THREAD) != 0; };
        if (std::ranges::any_of(contracts_, needs_one_thread)) options_.max_processes = 1;
    }

    [[nodiscard]] const std::vector<Contract>& contracts() const { return contracts_; }

    template <class Evaluate>
    void with_process(const Evaluate& evaluate) {
        std::unique_ptr<AnsweringProcess> answerer = take_process();
        try {
            evaluate(*answerer);
        } catch (...) {  // drops the process: what it may still write would be taken for a later answer
            const std::scoped_lock lock(mutex_);
            --running_;
            freed_.notify_one();
            throw;
        }
        const std::scoped_lock lock(mutex_);
        free_.push_back(std::move(answerer));
        freed_.notify_one();
    }

private:
    std::unique_ptr<AnsweringProcess> take_process() {
        std::unique_lock lock(mutex_);
        freed_.wait(lock, [this] { return !free_.empty() || running_ < std::max(1U, options_.max_processes); });
        if (!free_.empty()) {
            std::unique_ptr<AnsweringProcess> answerer = std::move(free_.back());
            free_.pop_back();
            return answerer;
        }

        // Starts a process without the lock, since others may return theirs in the meantime.
        ++running_;
        lock.unlock();
        auto answerer = std::make_unique<AnsweringProcess>(command_, options_);
        if (answerer->contracts != contracts_)
            answerer->child.fail(
                "sent a different header when it was started a second time; let it send the same header, or add "
                "flags=one_thread");
        return answerer;
    }

    std::string command_;
    PipeOptions options_;
    std::vector<Contract> contracts_;
    std::mutex mutex_;
    std::condition_variable freed_;
    std::vector<std::unique_ptr<AnsweringProcess>> free_;
    unsigned running_ = 0;
};

/// Sends a request and reads the header of the answer. Throws if the answer is an error. Returns true if the process
/// belongs to this program and reports `state_changed_bit`.
bool exchange_headers(ChildProcess& child, std::span<const std::byte> request, bool is_lostbits) {
    PipeAnswer answer;
    child.exchange(request, bytes_of(answer));
    if (std::memcmp(answer.magic, PipeAnswer{}.magic, sizeof answer.magic) != 0) {
        const std::string answer_start(reinterpret_cast<const char*>(&answer), sizeof answer);
        child.fail(
            "answered " + quote_text(answer_start) +
            ", but an answer begins with LBA1; it must answer every batch exactly once, and whatever it prints must "
            "go to standard error");
    }

    const bool state_changed = is_lostbits && (answer.error_bytes & state_changed_bit) != 0;
    if (state_changed) answer.error_bytes &= ~state_changed_bit;
    if (answer.error_bytes == 0) return state_changed;

    std::string text(std::min<std::size_t>(answer.error_bytes, 1000), ' ');
    child.read(std::as_writable_bytes(std::span(text)));
    child.fail("refuses: " + quote_text(text, 400));
}

PipeRequest make_pipe_request(std::uint32_t form_index, const lb_batch& batch) {
    PipeRequest request;
    request.form_index = form_index;
    request.ray_count = static_cast<std::uint32_t>(batch.size);
    request.primitive_count = batch.primitive_stride == 0 ? 1 : request.ray_count;
    request.end_count = batch.ends == nullptr ? 0 : request.ray_count;
    return request;
}

/// Returns the request columns of a batch as bytes.
std::array<std::span<const std::byte>, BatchColumn::request_columns> request_columns_of(const lb_batch& batch,
                                                                                        const ColumnBytes& bytes) {
    const auto column = [&bytes](const void* data, std::size_t k) {
        return std::span(static_cast<const std::byte*>(data), bytes[k]);
    };
    return {column(batch.rays, BatchColumn::rays), column(batch.starts, BatchColumn::starts),
            column(batch.ends, BatchColumn::ends), column(batch.primitives, BatchColumn::primitives)};
}

void evaluate_by_pipe(ChildProcess& child, const PipeRequest& request, const ColumnBytes& bytes,
                      const lb_batch& batch) {
    thread_local std::vector<std::byte> message;
    const auto header = std::as_bytes(std::span(&request, 1));
    message.assign(header.begin(), header.end());
    for (const auto& column : request_columns_of(batch, bytes))
        message.insert(message.end(), column.begin(), column.end());
    exchange_headers(child, message, false);
    child.read({static_cast<std::byte*>(batch.near_far), bytes[BatchColumn::near_far]});
    child.read({reinterpret_cast<std::byte*>(batch.hit), bytes[BatchColumn::hit]});
}

void evaluate_in_shared_memory(AnsweringProcess& answerer, const std::string& code_name, const PipeRequest& request,
                               const ColumnBytes& bytes, const lb_batch& batch) {
    const auto offsets = column_offsets(bytes);
    std::byte* const memory = answerer.memory->grow_to(offsets.back());
    if (memory == nullptr) throw std::bad_alloc();
    const auto request_columns = request_columns_of(batch, bytes);
    for (std::size_t k = 0; k < request_columns.size(); ++k) std::ranges::copy(request_columns[k], memory + offsets[k]);
    if (exchange_headers(answerer.child, std::as_bytes(std::span(&request, 1)), true))
        note_change(
            code_name,
            "changes how the processor computes during a call; lostbits undoes that after each call; let the code call "
            "fegetenv first and fesetenv last");
    std::memcpy(batch.near_far, memory + offsets[BatchColumn::near_far], bytes[BatchColumn::near_far]);
    std::memcpy(batch.hit, memory + offsets[BatchColumn::hit], bytes[BatchColumn::hit]);
}

void evaluate(AnsweringProcess& answerer, std::uint32_t form_index, const std::string& code_name,
              const Contract& contract, const lb_batch& batch) {
    const PipeRequest request = make_pipe_request(form_index, batch);
    answerer.child.set_subject("form \"" + contract.name + "\"");
    const ColumnBytes bytes = column_bytes(request, contract);
    if (answerer.memory) evaluate_in_shared_memory(answerer, code_name, request, bytes, batch);
    else evaluate_by_pipe(answerer.child, request, bytes, batch);
}

}  // namespace

ColumnBytes column_bytes(const PipeRequest& request, const Contract& contract) {
    const std::size_t width = static_cast<std::size_t>(contract.bits) / 8, n = request.ray_count;
    return {6 * n * width,
            (contract.flags & LB_RANGE) != 0 ? request.end_count * width : 0,
            request.end_count * width,
            request.primitive_count * row_of(contract.shape).number_count * width,
            2 * n * width,
            n};
}

std::array<std::size_t, BatchColumn::count + 1> column_offsets(const ColumnBytes& bytes) {
    std::array<std::size_t, BatchColumn::count + 1> offsets{};
    for (std::size_t k = 0; k < bytes.size(); ++k) offsets[k + 1] = offsets[k] + (bytes[k] + 63) / 64 * 64;
    return offsets;
}

std::vector<ForeignForm> open_pipe(const std::string& command, const PipeOptions& options) {
    PipeOptions named_options = options;
    if (named_options.message_prefix.empty()) named_options.message_prefix = "--pipe '" + command + "'";
    const auto pool = std::make_shared<Pool>(command, named_options);
    std::vector<ForeignForm> forms;
    std::uint32_t form_index = 0;
    for (const Contract& contract : pool->contracts()) {
        ForeignForm& form = forms.emplace_back(ForeignForm{contract, named_options.message_prefix, {}, true});
        form.answer = [pool, contract, form_index, code_name = name_in_messages(form)](const lb_batch& batch) {
            pool->with_process(
                [&](AnsweringProcess& answerer) { evaluate(answerer, form_index, code_name, contract, batch); });
        };
        ++form_index;
    }
    return forms;
}

}  // namespace lostbits::intersect::external
