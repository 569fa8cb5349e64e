#include "intersect/doors/pipe.hpp"

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>

#include "intersect/doors/child.hpp"
#include "intersect/doors/greeting.hpp"
#include "intersect/doors/pipe_header.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {

static_assert(std::endian::native == std::endian::little, "numbers go through pipes as they lie in memory");

namespace {

std::vector<Contract> greet(Child& child, const PipeTerms& terms) {
    return read_greeting({.next_line = [&child] { return child.read_line(); },
                          .fail = [&child](const std::string& what) { child.fail(what); }},
                         terms);
}

/// A shader's author has no say in how its process reads and writes.
std::string duty(const PipeTerms& terms) {
    return terms.ours ? "" : "it must read a whole batch, answer it and flush its output";
}

/// The processes of one command: as many as ask at the same time.
class Pool {
public:
    Pool(std::string command, const PipeTerms& terms) : command_(std::move(command)), terms_(terms) {
        free_.push_back(std::make_unique<Child>(command_, terms_.who, duty(terms_), terms_.seconds));
        contracts_ = greet(*free_.back(), terms_);
        running_ = 1;
        const auto alone = [](const Contract& c) { return (c.flags & LB_ONE_THREAD) != 0; };
        if (std::ranges::any_of(contracts_, alone)) terms_.processes = 1;
    }

    [[nodiscard]] const std::vector<Contract>& contracts() const { return contracts_; }

    template <class Ask>
    void with_child(const Ask& ask) {
        std::unique_ptr<Child> child = take();
        try {
            ask(*child);
        } catch (...) {  // what it may still write belongs to no later question
            const std::scoped_lock lock(mutex_);
            --running_;
            freed_.notify_one();
            throw;
        }
        const std::scoped_lock lock(mutex_);
        free_.push_back(std::move(child));
        freed_.notify_one();
    }

private:
    std::unique_ptr<Child> take() {
        std::unique_lock lock(mutex_);
        freed_.wait(lock, [this] { return !free_.empty() || running_ < std::max(1U, terms_.processes); });
        if (!free_.empty()) {
            std::unique_ptr<Child> child = std::move(free_.back());
            free_.pop_back();
            return child;
        }
        ++running_;
        lock.unlock();
        auto child = std::make_unique<Child>(command_, terms_.who, duty(terms_), terms_.seconds);
        if (greet(*child, terms_) != contracts_)
            child->fail(
                "says something else of itself when it is started a second time; let it say the same, or add "
                "flags=one_thread");
        return child;
    }

    std::string command_;
    PipeTerms terms_;
    std::vector<Contract> contracts_;
    std::mutex mutex_;
    std::condition_variable freed_;
    std::vector<std::unique_ptr<Child>> free_;
    unsigned running_ = 0;
};

/// The bytes of a request: its head, then columns one after the other.
class Message {
public:
    void add(const void* from, std::size_t bytes) {
        const auto* const first = static_cast<const std::byte*>(from);
        bytes_.insert(bytes_.end(), first, first + bytes);
    }
    void clear() { bytes_.clear(); }
    [[nodiscard]] std::span<const std::byte> all() const { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

template <class T>
std::span<std::byte> bytes_of(T& value) {
    return std::as_writable_bytes(std::span(&value, 1));
}

void ask(Child& child, std::uint32_t form, const Contract& contract, const lb_batch& batch) {
    thread_local Message message;
    const std::size_t width = static_cast<std::size_t>(contract.bits) / 8, n = batch.size;
    const std::size_t solids = batch.solid_stride == 0 ? 1 : n;
    PipeRequest head;
    head.form = form;
    head.rays = static_cast<std::uint32_t>(n);
    head.solids = static_cast<std::uint32_t>(solids);
    head.ends = batch.ends == nullptr ? 0 : head.rays;
    message.clear();
    message.add(&head, sizeof head);
    message.add(batch.rays, 6 * n * width);
    if (batch.ends) message.add(batch.ends, n * width);
    message.add(batch.solids, solids * number_names(contract.shape).size() * width);

    child.about("form \"" + contract.name + "\"");
    PipeAnswer answer;
    child.exchange(message.all(), bytes_of(answer));
    if (std::memcmp(answer.magic, PipeAnswer{}.magic, sizeof answer.magic) != 0) {
        const std::string got(reinterpret_cast<const char*>(&answer), sizeof answer);
        child.fail("answered " + shown_text(got) +
                   " where an answer begins with LBA1; whatever it prints must go to "
                   "standard error, and every batch be answered once");
    }
    if (answer.error != 0) {
        std::string text(std::min<std::size_t>(answer.error, 1000), ' ');
        child.read(std::as_writable_bytes(std::span(text)));
        child.fail("refuses: " + shown_text(text, 400));
    }
    child.read({static_cast<std::byte*>(batch.near_far), 2 * n * width});
    child.read({reinterpret_cast<std::byte*>(batch.hit), n});
}

}  // namespace

std::vector<ForeignForm> open_pipe(const std::string& command, const PipeTerms& terms) {
    PipeTerms named = terms;
    if (named.who.empty()) named.who = "--pipe '" + command + "'";
    const auto pool = std::make_shared<Pool>(command, named);
    std::vector<ForeignForm> forms;
    std::uint32_t place = 0;
    for (const Contract& contract : pool->contracts()) {
        forms.push_back({contract, named.who, [pool, contract, place](const lb_batch& batch) {
                             pool->with_child([&](Child& child) { ask(child, place, contract, batch); });
                         }});
        ++place;
    }
    return forms;
}

}  // namespace lostbits::intersect::doors
