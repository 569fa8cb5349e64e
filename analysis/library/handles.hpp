// The types behind the handles of the C interface, the tables and texts that a call returns, and the code around every
// call: errors, arguments, threads, progress.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "analysis/library/lostbits.h"
#include "analysis/selection/select.hpp"
#include "intersect/external/foreign_batch.hpp"
#include "intersect/function/function.hpp"
#include "intersect/process/floating_point.hpp"
#include "intersect/table/written_formula.hpp"
#include "measure/culling/culling.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "output/table/table.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/toml/file_names.hpp"

namespace lostbits::analysis::library {

/// One column of a table, with a value for each row. The values are codes of categories if `names` is not empty, texts
/// if the type is string, and numbers otherwise.
struct ResultColumn {
    output::file::Column description;
    std::vector<double> numbers = {};
    std::vector<std::optional<std::string>> texts = {};
    std::vector<std::uint8_t> codes = {};
    std::vector<std::string> names = {};    ///< name of the category of each code
    const std::uint8_t* colours = nullptr;  ///< three bytes for each name; null: no colours

    std::vector<const char*> text_pointers = {}, name_pointers = {};  ///< filled by `seal`
};

/// The rows of a CSV file, in memory.
class ResultTable {
public:
    ResultTable(std::string name, const std::vector<output::file::Column>& columns);
    /// A writer that adds rows here instead of to a file.
    [[nodiscard]] output::file::CsvWriter writer();
    /// The column of that name, which must exist.
    [[nodiscard]] ResultColumn& operator[](const std::string& column);
    /// Fills the pointers that C reads. No row may be added after it.
    void seal();

    std::string name;
    std::vector<ResultColumn> columns;
    [[nodiscard]] std::size_t row_count() const;
};

/// Fills a table with one row per ray of one form and format, from the bands of a map or a judgement.
class RayTable {
public:
    RayTable(ResultTable& table, const measure::evaluate::TestedForm& tested_form,
             const std::vector<const measure::metric::Metric*>& metrics);
    static std::vector<output::file::Column> columns(const std::vector<const measure::metric::Metric*>& metrics);
    void add_band(const measure::evaluate::BandResult& result);

private:
    ResultTable& table_;
    const measure::evaluate::TestedForm& tested_form_;
    const std::vector<const measure::metric::Metric*>& metrics_;
};

/// Primitives, and the triangles of meshes after them; `mesh` may be null.
scene::rays::PrimitiveList<double> primitive_list(std::vector<Primitive<double>> primitives,
                                                  std::shared_ptr<const scene::rays::StoredMesh> mesh);

/// The primitives of a scene in the numbers of a format, and the index that finds those that a ray can meet.
class SceneInFormat {
public:
    SceneInFormat(const scene::file::Scene& scene, const FloatFormat& format);
    /// The index, which is made on first use. Several threads may call this at once.
    [[nodiscard]] const measure::culling::Culler& culler() const;

    std::vector<Primitive<double>> primitives_beside_mesh;
    std::shared_ptr<const scene::rays::StoredMesh> mesh;  ///< its triangles come after the others; null: no mesh

private:
    mutable std::once_flag culler_made_;
    mutable std::optional<measure::culling::Culler> culler_;
};

/// Keeps the scenes with meshes that calls have converted to a format, until the scene changes: making an index over a
/// million triangles takes a second. Several threads may call `get` at once.
class SceneCache {
public:
    std::shared_ptr<const SceneInFormat> get(const scene::file::Scene& scene, const FloatFormat& format);
    void clear() { scenes_.clear(); }

private:
    std::mutex mutex_;
    std::map<std::tuple<int, int, int>, std::shared_ptr<const SceneInFormat>> scenes_;  ///< by precision, emin and emax
};

}  // namespace lostbits::analysis::library

struct lostbits_result {
    std::deque<lostbits::analysis::library::ResultTable> tables;
    std::vector<std::string> texts;

    template <class R>
    void add_table(const char* name, const lostbits::output::table::Table<R>& table, const std::vector<R>& rows) {
        auto csv = tables.emplace_back(name, table.columns()).writer();
        for (const R& row : rows) table.add_row(csv, row);
    }
};

struct lostbits_scene {
    lostbits::scene::file::Scene scene;
    std::string explain_arguments;      ///< arguments of `lostbits explain` that name this scene; empty if none can
    bool has_array_primitives = false;  ///< arrays gave the primitives, and replaced those that the scene was read with
    /// The scene in the numbers of each format that was asked for. A call that changes the scene clears this.
    std::unique_ptr<lostbits::analysis::library::SceneCache> stored =
        std::make_unique<lostbits::analysis::library::SceneCache>();
};

struct lostbits_form {
    std::unique_ptr<lostbits::intersect::external::ForeignIntersector> foreign_form = {};
    /// A function of C, C++ or Rust; set if `foreign_form`, `formulas` and `written` are not.
    std::unique_ptr<lostbits::intersect::function::UserFunction> function = {};
    std::array<std::shared_ptr<const lostbits::intersect::table::WrittenFormula>, 2> formulas = {};  ///< f32, f64
    std::optional<lostbits::intersect::table::WrittenForm> written = {};
    lostbits::intersect::table::Intersector form{};  ///< the function in its formats, the written operations elsewhere
    lostbits::intersect::table::Intersector
        written_form{};  ///< only the written operations; `form` if no operations are written
};

namespace lostbits::analysis::library {

inline int put_error(lostbits_error* error, ExitStatus status, const std::string& text) {
    if (error != nullptr) {
        error->code = static_cast<int>(status);
        std::size_t length = std::min(text.size(), sizeof error->text - 1);
        // Do not cut within a UTF-8 character: its bytes after the first are 10xxxxxx.
        while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80)
            --length;
        std::memcpy(error->text, text.data(), length);
        error->text[length] = '\0';
    }
    return static_cast<int>(status);
}

/// Replaces the options in a message of the program by the names of arguments: `--metric culprit` by `metrics culprit`.
std::string replace_options_by_arguments(std::string text);

inline constexpr std::string_view no_memory_text =
    "there is not enough memory; ask for fewer rays, forms, metrics or triangles";

/// Runs `act()`, which returns an ExitStatus, in the floating-point environment of IEEE 754. Turns an exception into a
/// code and a text.
template <class Act>
int run_guarded(lostbits_error* error, const Act& act) {
    const intersect::process::FloatingPointGuard guard;
    intersect::process::FloatingPointState::standard().apply();
    try {
        return put_error(error, act(), "");
    } catch (const Interrupted&) {
        return put_error(error, ExitStatus::interrupted, "interrupted: the call was asked to stop");
    } catch (const Error& e) {
        return put_error(error, e.status(), replace_options_by_arguments(e.what()));
    } catch (const std::bad_alloc&) {
        return put_error(error, ExitStatus::environment, std::string(no_memory_text));
    } catch (const std::length_error&) {  // more items than any memory holds
        return put_error(error, ExitStatus::environment, std::string(no_memory_text));
    } catch (const std::filesystem::filesystem_error& e) {
        return put_error(error, ExitStatus::bad_input, scene::toml::error_phrase(e));
    } catch (const std::exception& e) {
        return put_error(error, ExitStatus::internal, std::string("a fault of lostbits: ") + e.what());
    }
}

/// Passes the result to the caller, who owns it from then on.
inline ExitStatus hand_over(std::unique_ptr<lostbits_result> content, lostbits_result** result,
                            ExitStatus exit = ExitStatus::done) {
    for (ResultTable& table : content->tables) table.seal();
    *result = content.release();
    return exit;
}

/// Throws InputError if a required argument is NULL.
inline void require(const void* argument, const char* name) {
    if (argument == nullptr) throw InputError(std::string(name) + " is NULL; give one");
}

/// An argument of `count` rows with `items` items each. Throws InputError if there are rows but no array, or more items
/// than memory can have.
template <class T>
std::span<const T> to_span(const T* first, std::size_t count, const std::string& name, std::size_t items = 1) {
    if (count > static_cast<std::size_t>(PTRDIFF_MAX) / (items * sizeof(T)))
        throw InputError(name + ": the count is " + std::to_string(count) + ", more than any memory holds");
    if (count > 0 && first == nullptr)
        throw InputError(name + " is NULL and the count is " + std::to_string(count) +
                         "; give an array, or a count of 0");
    return {first, count * items};
}

/// The texts of a list. Throws InputError, which names the list, if one of the texts is NULL.
inline std::vector<std::string> to_strings(const lostbits_words& list, const std::string& name) {
    std::vector<std::string> texts;
    for (const char* const text : to_span(list.words, list.count, name)) {
        require(text, ("a text of " + name).c_str());
        texts.emplace_back(text);
    }
    return texts;
}

/// Makes a stop token from a byte that the caller owns. A thread of another language may set the byte at any time, so
/// it is read as an atomic flag.
inline intersect::process::StopToken make_stop_token(const unsigned char* byte) {
    static_assert(sizeof(std::atomic<bool>) == 1 && std::atomic<bool>::is_always_lock_free);
    return byte ? intersect::process::StopToken(*reinterpret_cast<const std::atomic<bool>*>(byte))
                : intersect::process::StopToken();
}

/// The optional settings of a call: threads, stop flag, progress. They apply as long as this object lives.
class CallSettings {
public:
    explicit CallSettings(const lostbits_run* run) : run_(run ? *run : lostbits_run{}), limit_(read_threads(run_)) {}
    [[nodiscard]] intersect::process::StopToken stop() const { return make_stop_token(run_.stop); }
    /// Returns a function that adds a number of finished units of work and reports the sum to the caller. `total` is
    /// the number of all units.
    [[nodiscard]] std::function<void(std::uint64_t)> advance_callback(std::uint64_t total) {
        return [this, total](std::uint64_t units) {
            stop().check();
            if (run_.progress == nullptr) return;
            const std::lock_guard lock(mutex_);
            done_ += units;
            run_.progress(run_.own, done_, total);
        };
    }

private:
    static int read_threads(const lostbits_run& run) {
        if (run.threads < 0)
            throw InputError("threads is " + std::to_string(run.threads) +
                             "; give 0 for one per core, or a number above 0");
        return run.threads;
    }

    lostbits_run run_;
    selection::ThreadLimit limit_;
    std::mutex mutex_;
    std::uint64_t done_ = 0;
};

/// The selection of a call: its arguments, and the forms in formats and the metrics that they name. The caller's own
/// forms come before those of the catalogue.
struct CallSelection {
    lostbits_choice arguments;       ///< as the caller gave them
    std::vector<std::string> forms;  ///< as given, for messages and for sets
    std::vector<measure::evaluate::TestedForm> tested_forms;
    measure::metric::MetricSet metric_set = {};
    std::vector<const measure::metric::Metric*> extra_metrics = {};

    /// Meaning of a call that names no form.
    enum class WithoutForms { all_forms, no_form };
    explicit CallSelection(const lostbits_choice* given, WithoutForms without_forms = WithoutForms::all_forms);
    /// Keeps the tested forms that can test the subject called `name`. Throws NothingSelected if none is left.
    void keep_forms_for(const std::string& name, const selection::ShapePredicate& can_test);
};

/// Adds a table with a row per ray for each of these forms, if the call asks for rows.
std::deque<RayTable> add_ray_tables(lostbits_result& result, const CallSelection& chosen,
                                    const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                    const std::vector<const measure::metric::Metric*>& metrics);

/// A file in memory that holds a text, as long as this object lives.
class TextFile {
public:
    explicit TextFile(const std::string& text);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Runs `act()`. An InputError about the file says `text:LINE:COLUMN` in place of the path.
    template <class Act>
    auto run_with_text_positions(const Act& act) const {
        try {
            return act();
        } catch (const InputError& e) {
            std::string message = e.what();
            if (message.starts_with(path_)) message.replace(0, path_.size(), "text");
            throw InputError(message);
        }
    }

private:
    int file_;
    std::string path_;
};

}  // namespace lostbits::analysis::library
