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

using process::Child;
using process::SharedMemory;

std::vector<Contract> greet(Child& child, const PipeTerms& terms) {
    return read_greeting({.next_line = [&child] { return child.read_line(); },
                          .fail = [&child](const std::string& what) { child.fail(what); }},
                         terms);
}

/// Advice for the author of the program. A process of this program needs none: the author of a shader has no say in how
/// it reads and writes.
std::string author_advice(const PipeTerms& terms) {
    return terms.is_lostbits ? "" : "it must read a whole batch, answer it and flush its output";
}

template <class T>
std::span<std::byte> bytes_of(T& value) {
    return std::as_writable_bytes(std::span(&value, 1));
}

/// A process that answers and, if it is one of this program, the memory that it shares with this process.
struct Partner {
    Partner(const std::string& command, const PipeTerms& terms)
        : memory(terms.is_lostbits ? std::make_unique<SharedMemory>() : nullptr),
          child(command, {terms.message_prefix, author_advice(terms), terms.seconds, memory ? memory->descriptor() : -1,
                          terms.stop}),
          contracts(greet(child, terms)) {
        if (memory && memory->descriptor() < 0) memory.reset();
        if (!memory) return;
        PipeRequest shared;
        std::memcpy(shared.magic, shares_memory, sizeof shared.magic);
        child.exchange(bytes_of(shared), {});
    }

    std::unique_ptr<SharedMemory> memory;
    Child child;
    std::vector<Contract> contracts;
};

/// The processes of one command: one for each thread that asks at the same time, up to the limit of the terms.
class Pool {
public:
    Pool(std::string command, const PipeTerms& terms) : command_(std::move(command)), terms_(terms) {
        free_.push_back(std::make_unique<Partner>(command_, terms_));
        contracts_ = free_.back()->contracts;
        running_ = 1;
        const auto alone = [](const Contract& c) { return (c.flags & LB_ONE_THREAD) != 0; };
        if (std::ranges::any_of(contracts_, alone)) terms_.processes = 1;
    }

    [[nodiscard]] const std::vector<Contract>& contracts() const { return contracts_; }

    template <class Evaluate>
    void with_partner(const Evaluate& evaluate) {
        std::unique_ptr<Partner> partner = take();
        try {
            evaluate(*partner);
        } catch (...) {  // drops the process: what it may still write would be taken for a later answer
            const std::scoped_lock lock(mutex_);
            --running_;
            freed_.notify_one();
            throw;
        }
        const std::scoped_lock lock(mutex_);
        free_.push_back(std::move(partner));
        freed_.notify_one();
    }

private:
    std::unique_ptr<Partner> take() {
        std::unique_lock lock(mutex_);
        freed_.wait(lock, [this] { return !free_.empty() || running_ < std::max(1U, terms_.processes); });
        if (!free_.empty()) {
            std::unique_ptr<Partner> partner = std::move(free_.back());
            free_.pop_back();
            return partner;
        }
        ++running_;
        lock.unlock();
        auto partner = std::make_unique<Partner>(command_, terms_);
        if (partner->contracts != contracts_)
            partner->child.fail(
                "sent a different header when it was started a second time; let it send the same header, or add "
                "flags=one_thread");
        return partner;
    }

    std::string command_;
    PipeTerms terms_;
    std::vector<Contract> contracts_;
    std::mutex mutex_;
    std::condition_variable freed_;
    std::vector<std::unique_ptr<Partner>> free_;
    unsigned running_ = 0;
};

/// Sends a request and reads the answer except its columns. Throws if the answer is an error. True if a process of this
/// program reports `changes_state`.
bool exchange_heads(Child& child, std::span<const std::byte> request, bool is_lostbits) {
    PipeAnswer answer;
    child.exchange(request, bytes_of(answer));
    if (std::memcmp(answer.magic, PipeAnswer{}.magic, sizeof answer.magic) != 0) {
        const std::string got(reinterpret_cast<const char*>(&answer), sizeof answer);
        child.fail(
            "answered " + shown_text(got) +
            ", but an answer begins with LBA1; it must answer every batch exactly once, and whatever it prints must "
            "go to standard error");
    }
    const bool changed = is_lostbits && (answer.error_bytes & changes_state) != 0;
    if (changed) answer.error_bytes &= ~changes_state;
    if (answer.error_bytes == 0) return changed;
    std::string text(std::min<std::size_t>(answer.error_bytes, 1000), ' ');
    child.read(std::as_writable_bytes(std::span(text)));
    child.fail("refuses: " + shown_text(text, 400));
}

PipeRequest request_of(std::uint32_t form, const lb_batch& batch) {
    PipeRequest request;
    request.form = form;
    request.rays = static_cast<std::uint32_t>(batch.size);
    request.primitives = batch.primitive_stride == 0 ? 1 : request.rays;
    request.ends = batch.ends == nullptr ? 0 : request.rays;
    return request;
}

/// The request columns of a batch, as bytes.
std::array<std::span<const std::byte>, BatchColumn::asked> asked_by(const lb_batch& batch, const ColumnBytes& bytes) {
    const auto column = [&bytes](const void* from, std::size_t k) {
        return std::span(static_cast<const std::byte*>(from), bytes[k]);
    };
    return {column(batch.rays, BatchColumn::rays), column(batch.starts, BatchColumn::starts),
            column(batch.ends, BatchColumn::ends), column(batch.primitives, BatchColumn::primitives)};
}

void evaluate_by_pipe(Child& child, const PipeRequest& request, const ColumnBytes& bytes, const lb_batch& batch) {
    thread_local std::vector<std::byte> message;
    const auto head = std::as_bytes(std::span(&request, 1));
    message.assign(head.begin(), head.end());
    for (const auto& column : asked_by(batch, bytes)) message.insert(message.end(), column.begin(), column.end());
    exchange_heads(child, message, false);
    child.read({static_cast<std::byte*>(batch.near_far), bytes[BatchColumn::near_far]});
    child.read({reinterpret_cast<std::byte*>(batch.hit), bytes[BatchColumn::hit]});
}

void evaluate_in_memory(Partner& partner, const std::string& who, const PipeRequest& request, const ColumnBytes& bytes,
                        const lb_batch& batch) {
    const auto at = places_of(bytes);
    std::byte* const data = partner.memory->with_bytes(at.back());
    if (data == nullptr) throw std::bad_alloc();
    const auto asked = asked_by(batch, bytes);
    for (std::size_t k = 0; k < asked.size(); ++k) std::ranges::copy(asked[k], data + at[k]);
    if (exchange_heads(partner.child, std::as_bytes(std::span(&request, 1)), true))
        note_change(
            who,
            "changes how the processor computes during a call; lostbits undoes that after each call; let the code call "
            "fegetenv first and fesetenv last");
    std::memcpy(batch.near_far, data + at[BatchColumn::near_far], bytes[BatchColumn::near_far]);
    std::memcpy(batch.hit, data + at[BatchColumn::hit], bytes[BatchColumn::hit]);
}

void evaluate(Partner& partner, std::uint32_t form, const std::string& who, const Contract& contract,
              const lb_batch& batch) {
    const PipeRequest request = request_of(form, batch);
    partner.child.about("form \"" + contract.name + "\"");
    const ColumnBytes bytes = column_bytes(request, contract);
    if (partner.memory) evaluate_in_memory(partner, who, request, bytes, batch);
    else evaluate_by_pipe(partner.child, request, bytes, batch);
}

}  // namespace

ColumnBytes column_bytes(const PipeRequest& request, const Contract& contract) {
    const std::size_t width = static_cast<std::size_t>(contract.bits) / 8, n = request.rays;
    return {6 * n * width,        (contract.flags & LB_RANGE) != 0 ? request.ends * width : 0,
            request.ends * width, request.primitives * row_of(contract.shape).numbers * width,
            2 * n * width,        n};
}

std::array<std::size_t, BatchColumn::count + 1> places_of(const ColumnBytes& bytes) {
    std::array<std::size_t, BatchColumn::count + 1> at{};
    for (std::size_t k = 0; k < bytes.size(); ++k) at[k + 1] = at[k] + (bytes[k] + 63) / 64 * 64;
    return at;
}

std::vector<ForeignForm> open_pipe(const std::string& command, const PipeTerms& terms) {
    PipeTerms named = terms;
    if (named.message_prefix.empty()) named.message_prefix = "--pipe '" + command + "'";
    const auto pool = std::make_shared<Pool>(command, named);
    std::vector<ForeignForm> forms;
    std::uint32_t place = 0;
    for (const Contract& contract : pool->contracts()) {
        ForeignForm& form = forms.emplace_back(ForeignForm{contract, named.message_prefix, {}, true});
        form.answer = [pool, contract, place, who = name_in_messages(form)](const lb_batch& batch) {
            pool->with_partner([&](Partner& partner) { evaluate(partner, place, who, contract, batch); });
        };
        ++place;
    }
    return forms;
}

}  // namespace lostbits::intersect::external
