// Probes how a form is called: it must write every answer, and give the same answers in any batch and thread.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "measure/contract/trial.hpp"

namespace lostbits::measure::contract {
namespace {

/// True if both replies have equal numbers. Two NaN count as equal.
bool are_same(const Reply& a, const Reply& b) {
    const auto is_same_number = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.hit == b.hit && is_same_number(a.near, b.near) && is_same_number(a.far, b.far);
}

bool are_all_same(const std::vector<Reply>& a, const std::vector<Reply>& b) {
    return std::ranges::equal(a, b, are_same);
}

/// Many rays from all directions, some of which meet the primitive.
std::vector<Question> make_scattered_questions(Shape shape) {
    std::vector<Question> questions;
    std::uint32_t state = 1;
    const auto random = [&state] {
        state = state * 1664525U + 1013904223U;
        return static_cast<double>(state >> 16) / 32768 - 1;
    };
    for (int i = 0; i < 501; ++i) {
        Question q = question_along_z(shape, 0, 1);
        auto& [origin, direction] = q.ray;
        for (int k = 0; k < 3; ++k) origin[k] = 8 * random();

        // The direction points to a place around the middle of the primitive, and is of unit length.
        double squared_length = 0;
        for (int k = 0; k < 3; ++k) {
            direction[k] = 2 * random() - origin[k];
            squared_length += direction[k] * direction[k];
        }
        for (int k = 0; k < 3; ++k) direction[k] /= std::sqrt(squared_length);
        questions.push_back(q);
    }
    return questions;
}

void try_hit_is_written(Trial& trial) {
    const auto replies = ask(trial.form, make_scattered_questions(trial.shape));
    const auto unwritten = std::ranges::find_if(replies, [](const Reply& reply) { return reply.hit > 1; });
    if (unwritten != replies.end())
        trial.report_broken("`hit` is " + std::to_string(unwritten->hit) +
                            " for a ray of a batch; write 1 or 0 for every ray");
}

void try_same_batch_again(Trial& trial) {
    const auto questions = make_scattered_questions(trial.shape);
    const auto replies = ask(trial.form, questions);
    trial.check(are_all_same(replies, ask(trial.form, questions)), "the same batch gets the same answers again",
                "the same batch gets other answers the second time: the function keeps state from the first call, or "
                "reads memory that was never written");
}

void try_batches(Trial& trial) {
    const auto questions = make_scattered_questions(trial.shape);
    std::vector<Reply> single_replies;
    for (const Question& question : questions) single_replies.push_back(trial.ask(question));
    trial.check(are_all_same(ask(trial.form, questions), single_replies),
                "a ray gets the same answer in a batch and alone", "a ray gets another answer in a batch than alone");
}

void try_primitives(Trial& trial) {
    const auto questions = make_scattered_questions(trial.shape);
    trial.check(are_all_same(ask(trial.form, questions), ask(trial.form, questions, BatchPrimitives::first_for_all)),
                "one primitive for all rays, or one for each: the same answers",
                "the primitives of each ray (primitive_stride) are ignored; step by primitive_stride from ray to ray");
}

void try_threads(Trial& trial) {
    const auto questions = make_scattered_questions(trial.shape);
    const auto expected = ask(trial.form, questions);

    // Each thread repeats the batch. The last error of any of them is passed on.
    std::atomic<bool> is_same = true;
    std::exception_ptr error;
    std::mutex lock;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            try {
                for (int k = 0; k < 20; ++k) is_same = is_same && are_all_same(expected, ask(trial.form, questions));
            } catch (...) {
                const std::scoped_lock guard(lock);
                error = std::current_exception();
            }
        });
    }
    for (std::thread& t : threads) t.join();

    if (error) std::rethrow_exception(error);
    trial.check(is_same, "four threads at once get the same answers",
                "four threads at once get other answers; say LB_ONE_THREAD (one_thread)");
}

}  // namespace

void probe_calls(Trial& trial) {
    trial.probe("answers", try_hit_is_written);
    trial.probe("again", try_same_batch_again);
    if (trial.has_broken("again")) {
        trial.report_note("the probes batches, primitives and threads compare repeated answers, so they are left out");
    } else {
        trial.probe("batches", try_batches);
        trial.probe("primitives", try_primitives);
        if (!trial.has_flag(LB_ONE_THREAD)) trial.probe("threads", try_threads);
    }
}

}  // namespace lostbits::measure::contract
