// The claims by subject: a filter, a sort order, and the command that measures each claim again.

/** Sort keys of the rows. The report's own order is that of the claim files. */
const claimOrders = {
    "as in the files": (row) => row.dataset.place,
    verdict: (row) => row.dataset.grave,
    sentence: (row) => row.cells[1].textContent,
    "measured on": (row) => row.cells[2].textContent,
    quantity: (row) => row.cells[3].textContent,
    measured: (row) => row.dataset.measured,
    expected: (row) => row.cells[5].querySelector("data")?.value ?? ""
};

/** Compares numbers by size and other texts by the alphabet; empty keys come last. */
function compareKeys(a, b) {
    if (a === "" || b === "") return (a === "") - (b === "");
    const [x, y] = [a, b].map((key) => Number(asNumber(key)));
    return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b) : x - y;
}

function sortClaims(order, falling) {
    for (const table of document.querySelectorAll("table.claims")) {
        const rows = [...table.tBodies[0].rows], key = claimOrders[order];
        rows.sort((a, b) => (falling ? -1 : 1) * compareKeys(key(a), key(b)) || a.dataset.place - b.dataset.place);
        table.tBodies[0].append(...rows);
        for (const head of table.tHead.rows[0].cells)
            head.ariaSort = head.textContent.trim() === order ? (falling ? "descending" : "ascending") : "none";
    }
}

function buildClaims() {
    const root = document.getElementById("claim-view"), subjects = [...document.querySelectorAll("details.subject")],
          rows = [...document.querySelectorAll("table.claims tbody tr")];
    const copied = make("pre.copied", { hidden: true }), count = make("span", { "aria-live": "polite" });
    const filter = make("input", { type: "search", id: "filter", placeholder: "a word, or a verdict" });
    filter.addEventListener("input", () => {
        const asked = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
        for (const row of rows) {
            const text = row.textContent.toLowerCase();
            row.hidden = !asked.every((w) => text.includes(w));
        }
        for (const subject of subjects) {
            const left = subject.querySelector("tbody tr:not([hidden])") !== null;
            subject.hidden = !left;
            subject.open = left && asked.length > 0;
        }
        count.textContent = asked.length > 0 ? `${rows.filter((r) => !r.hidden).length} of ${rows.length}` : "";
    });
    const order = { by: "as in the files", falling: false };
    const sortBy = (by) => {
        order.falling = order.by === by && !order.falling && by !== "as in the files";
        order.by = by;
        document.getElementById("pick-order").value = by;
        sortClaims(by, order.falling);
    };
    rows.forEach((row, k) => {
        row.dataset.place = k;
        const copy = () => copyText(row.dataset.command, copied);
        row.lastElementChild.append(make("br"), button(".small", copy, "copy the command"));
    });
    for (const head of document.querySelectorAll("table.claims thead th")) {
        const by = head.textContent;
        head.replaceChildren(button(".order", () => sortBy(by), by));
    }
    const openAll = (open) => subjects.forEach((subject) => (subject.open = open));
    root.append(
        make(
            "div.pickers", make("label", "filter ", filter), count,
            choice("sorted by", "pick-order", Object.keys(claimOrders).map((o) => [o, o]), order.by, sortBy),
            button("#open-claims", () => openAll(true), "open all"),
            button("#close-claims", () => openAll(false), "close all")),
        copied);
    root.hidden = false;
}
