// Forms of the caller, and the choice of forms, formats and metrics of a call.
#include "analysis/library/handles.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::library {

using intersect::external::ForeignForm;
using intersect::table::WrittenFormula;

namespace {

/// A form that runs a function of the caller in this process.
ForeignForm make_foreign_form(const lb_form& caller_form) {
    ForeignForm foreign{intersect::external::read_form_contract(caller_form, "form"), "form", {}};
    const auto run = caller_form.run;
    void* const user_data = caller_form.own;
    foreign.answer = [run, user_data, name = foreign.contract.name](const lb_batch& given_batch) {
        const intersect::process::FloatingPointGuard guard;
        lb_batch batch = given_batch;
        batch.own = user_data;
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
                     text::did_you_mean(name ? name : "", names));
}

/// Updates both forms after a formula was added.
void update_forms(lostbits_form& form) {
    form.form = form.written_form = form.foreign_form->to_intersector();
    if (!form.formulas[0] && !form.formulas[1]) return;
    form.written.emplace(form.formulas[0], form.formulas[1]);
    form.written->fill(form.form);
    form.written_form = form.written->make_intersector(form.foreign_form->info);
}

}  // namespace

CallSelection::CallSelection(const lostbits_choice* given, WithoutForms without_forms)
    : arguments(given ? *given : lostbits_choice{}) {
    forms = to_strings(arguments.forms, "forms");
    std::vector<std::string> formats = to_strings(arguments.formats, "formats");
    if (formats.empty()) formats = {"f32", "f64"};
    if (forms.empty() && arguments.own_count == 0 && without_forms == WithoutForms::all_forms) forms = {"*"};

    // The forms of the caller come first.
    std::vector<const intersect::table::Intersector*> selected;
    for (const lostbits_form* const caller_form : to_span(arguments.own, arguments.own_count, "own")) {
        require(caller_form, "a form of `own`");
        selected.push_back(arguments.written != 0 ? &caller_form->written_form : &caller_form->form);
    }
    if (!forms.empty()) std::ranges::copy(selection::select_forms(forms, "forms"), std::back_inserter(selected));
    if (!selected.empty())
        tested_forms = selection::pair_forms_with_formats(selected, selection::select_formats(formats, "formats"));
    extra_metrics = selection::select_metrics(to_strings(arguments.metrics, "metrics"), metric_set);
}

void CallSelection::keep_forms_for(const std::string& name, const selection::ShapePredicate& can_test) {
    tested_forms = selection::tested_forms_handling({tested_forms, forms, true}, name, can_test);
    if (tested_forms.empty())
        throw NothingSelected(name +
                              ": none of the chosen forms and formats can test its primitives; choose other "
                              "forms or formats");
}

}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis::library;

extern "C" {

int lostbits_form_make(const lb_form* forms, size_t count, lostbits_form** form, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(forms, "forms");
        require(form, "form");
        if (count != 1 && count != 2) throw InputError("count must be 1, or 2 to give a form for each of two formats");
        auto created = std::make_unique<lostbits_form>();
        created->foreign_form = std::make_unique<intersect::external::ForeignIntersector>(make_foreign_form(forms[0]));
        if (count == 2) created->foreign_form->add(make_foreign_form(forms[1]));
        update_forms(*created);
        *form = created.release();
        return ExitStatus::done;
    });
}

int lostbits_form_write(lostbits_form* form, int bits, const lostbits_operation* operations, size_t count, int32_t hit,
                        int32_t t, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(form, "form");
        require(operations, "operations");
        if (form->foreign_form == nullptr)
            throw InputError(
                "form: the operations of this form come from its source file; call lostbits_form_write only for a "
                "form that was made without a file");
        if (bits != 32 && bits != 64) throw InputError("bits must be 32 or 64");

        WrittenFormula formula{.name = std::string(form->foreign_form->info.name),
                               .shape = form->form.shape,
                               .operations = {},
                               .hit = hit,
                               .t = t};
        for (const lostbits_operation& operation : to_span(operations, count, "operations"))
            formula.operations.push_back(
                {.op = parse_operation(operation.op),
                 .operands = {operation.operands[0], operation.operands[1], operation.operands[2]},
                 .value = operation.value,
                 .label = operation.label ? operation.label : ""});
        require_valid(formula);

        form->formulas[bits == 32 ? 0 : 1] = std::make_shared<const WrittenFormula>(std::move(formula));
        update_forms(*form);
        return ExitStatus::done;
    });
}

int lostbits_form_function(const char* named, lostbits_form** form, const lostbits_run* run, lostbits_result** result,
                           lostbits_error* error) {
    return run_guarded(error, [&] {
        require(named, "named");
        require(form, "form");
        require(result, "result");
        auto created = std::make_unique<lostbits_form>();
        created->function = intersect::function::load_function(named, {.stop = CallSettings(run).stop()});
        const auto& function = *created->function;
        created->form = function.intersector;
        created->written_form = function.written->make_intersector(function.answers->info);

        // The result says what the arguments were taken for.
        auto signature_result = std::make_unique<lostbits_result>();
        signature_result->tables
            .emplace_back("function",
                          std::vector<output::file::Column>{
                              {"name", "string", "", "name of the form"},
                              {"shape", "string", "", "shape that it intersects"},
                              {"signature", "string", "", "what its arguments and its result are taken for"}})
            .writer()
            .add(function.answers->info.name)
            .add(name_of(function.intersector.shape))
            .add(function.signature_text)
            .end_row();
        hand_over(std::move(signature_result), result);
        *form = created.release();
        return ExitStatus::done;
    });
}

void lostbits_form_free(lostbits_form* form) { delete form; }
}
