// Forms of the caller, and the choice of forms, formats and metrics of a call.
#include "analysis/library/handles.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::analysis::library {

using intersect::external::ForeignForm;
using intersect::table::WrittenFormula;

namespace {

/// A form that runs a function of the caller in this process.
ForeignForm foreign_of(const lb_form& given) {
    ForeignForm foreign{intersect::external::contract_of(given, "form"), "form", {}};
    const auto run = given.run;
    void* const own = given.own;
    foreign.answer = [run, own, name = foreign.contract.name](const lb_batch& given_batch) {
        const intersect::process::FloatingPointGuard guard;
        lb_batch batch = given_batch;
        batch.own = own;
        if (const char* const reason = run(&batch)) throw EnvironmentError("form " + name + ": " + reason);
    };
    return foreign;
}

TapeOp parse_operation(const char* name) {
    const auto row = std::ranges::find(tape_operations, std::string_view(name ? name : ""), &TapeOpRow::name);
    if (row != tape_operations.end()) return row->op;
    std::vector<std::string> names;
    for (const TapeOpRow& operation : tape_operations) names.emplace_back(operation.name);
    throw InputError("operation \"" + std::string(name ? name : "") + "\" is unknown; " +
                     scene::toml::did_you_mean(name ? name : "", names));
}

/// Updates both rows after a formula was added.
void update_rows(lostbits_form& form) {
    form.row = form.written_row = form.foreign_row->row();
    if (!form.formulas[0] && !form.formulas[1]) return;
    form.written.emplace(form.formulas[0], form.formulas[1]);
    form.written->fill(form.row);
    form.written_row = form.written->row(form.foreign_row->info);
}

}  // namespace

Selection::Selection(const lostbits_choice* given, bool may_be_empty) : choice(given ? *given : lostbits_choice{}) {
    forms = texts_of(choice.forms, "forms");
    std::vector<std::string> formats = texts_of(choice.formats, "formats");
    if (formats.empty()) formats = {"f32", "f64"};
    if (forms.empty() && choice.own_count == 0 && !may_be_empty) forms = {"*"};
    std::vector<const intersect::table::Intersector*> selected;
    for (const lostbits_form* const own_form : array_of(choice.own, choice.own_count, "own")) {
        require(own_form, "a form of `own`");
        selected.push_back(choice.written != 0 ? &own_form->written_row : &own_form->row);
    }
    if (!forms.empty()) std::ranges::copy(selection::select_forms(forms, "forms"), std::back_inserter(selected));
    if (!selected.empty()) rows = selection::cross(selected, selection::select_formats(formats, "formats"));
    extra_metrics = selection::select_metrics(texts_of(choice.metrics, "metrics"), metric_set);
}

void Selection::keep_rows_for(const std::string& name, const selection::ShapePredicate& meets) {
    rows = selection::rows_meeting({rows, forms, true}, name, meets);
    if (rows.empty())
        throw NothingSelected(name +
                              ": has primitives that no chosen form takes in a chosen format; choose other "
                              "forms or formats");
}

}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis::library;

extern "C" {

int lostbits_form_make(const lb_form* forms, size_t count, lostbits_form** form, lostbits_error* error) {
    return guarded(error, [&] {
        require(forms, "forms");
        require(form, "form");
        if (count != 1 && count != 2) throw InputError("count must be 1, or 2 to give a form for each of two formats");
        auto created = std::make_unique<lostbits_form>();
        created->foreign_row = std::make_unique<intersect::external::ForeignRow>(foreign_of(forms[0]));
        if (count == 2) created->foreign_row->add(foreign_of(forms[1]));
        update_rows(*created);
        *form = created.release();
        return Exit::done;
    });
}

int lostbits_form_write(lostbits_form* form, int bits, const lostbits_operation* operations, size_t count, int32_t hit,
                        int32_t t, lostbits_error* error) {
    return guarded(error, [&] {
        require(form, "form");
        require(operations, "operations");
        if (form->foreign_row == nullptr)
            throw InputError(
                "form: the operations of this form come from its source file; call lostbits_form_write only for a "
                "form that was made without a file");
        if (bits != 32 && bits != 64) throw InputError("bits must be 32 or 64");
        WrittenFormula formula{.name = std::string(form->foreign_row->info.name),
                               .shape = form->row.shape,
                               .operations = {},
                               .hit = hit,
                               .t = t};
        for (const lostbits_operation& o : array_of(operations, count, "operations"))
            formula.operations.push_back({.op = parse_operation(o.op),
                                          .operands = {o.operands[0], o.operands[1], o.operands[2]},
                                          .value = o.value,
                                          .label = o.label ? o.label : ""});
        require_valid(formula);
        form->formulas[bits == 32 ? 0 : 1] = std::make_shared<const WrittenFormula>(std::move(formula));
        update_rows(*form);
        return Exit::done;
    });
}

int lostbits_form_function(const char* named, lostbits_form** form, const lostbits_run* run, lostbits_result** result,
                           lostbits_error* error) {
    return guarded(error, [&] {
        require(named, "named");
        require(form, "form");
        require(result, "result");
        auto created = std::make_unique<lostbits_form>();
        created->function = intersect::function::load_function(named, {.stop = CallRun(run).stop()});
        const auto& function = *created->function;
        created->row = function.row;
        created->written_row = function.written->row(function.answers->info);
        auto found = std::make_unique<lostbits_result>();
        found->tables
            .emplace_back("function",
                          std::vector<output::file::Column>{
                              {"name", "string", "", "name of the form"},
                              {"shape", "string", "", "shape that it intersects"},
                              {"signature", "string", "", "what its arguments and its result are taken for"}})
            .writer()
            .add(function.answers->info.name)
            .add(name_of(function.row.shape))
            .add(function.signature_text)
            .end_row();
        hand_over(std::move(found), result);
        *form = created.release();
        return Exit::done;
    });
}

void lostbits_form_free(lostbits_form* form) { delete form; }
}
