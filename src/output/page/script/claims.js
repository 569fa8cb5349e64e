// The table of claims: a filter, and the command of each.

function buildClaims() {
    const root = document.getElementById("claim-view"), rows = [...document.querySelectorAll("table.claims tbody tr")];
    const copied = make("pre", { className: "copied", hidden: true }), count = make("span", { "aria-live": "polite" });
    const filter = make("input", { type: "search", id: "filter", placeholder: "a word, or a verdict" });
    filter.addEventListener("input", () => {
        const asked = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
        let left = 0;
        for (const row of rows) {
            const text = row.textContent.toLowerCase();
            row.hidden = !asked.every((w) => text.includes(w));
            left += row.hidden ? 0 : 1;
        }
        count.textContent = asked.length > 0 ? `${left} of ${rows.length}` : "";
    });
    for (const row of rows) {
        row.lastElementChild.append(
            make("br"),
            make(
                "button", { type: "button", className: "small", onclick: () => copyText(row.dataset.command, copied) },
                "copy the command"));
    }
    root.append(make("label", {}, "filter ", filter), " ", count, copied);
    root.hidden = false;
}
