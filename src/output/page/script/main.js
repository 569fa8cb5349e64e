// Puts the parts together, follows links inside the page and says when it is ready.

function follow() {
    if (!readHash(location.hash)) return Promise.resolve();
    const note = document.getElementById("note");
    note.hidden = notes.length === 0;
    note.textContent = notes.join("; ");
    return goTo({});
}

function scrollToSubject(hash) {
    const asked = new URLSearchParams(hash.replace(/^#/, ""));
    const part = asked.has("scene") ? "maps" : asked.has("sweep") ? "sweeps" : asked.has("shape") ? "trade" : "";
    document.getElementById(part)?.scrollIntoView();
}

/** Plots are drawn in the colours and the room of the moment. */
function redraw() {
    sweepParts.shown = tradeParts.shown = "";
    return goTo({});
}

async function start() {
    document.querySelector("header").append(make("p", { id: "note", hidden: true, role: "status" }));
    if (index.maps.length > 0) {
        buildMaps();
        buildPanes();
    }
    if (index.sweeps.length > 0) buildSweeps();
    if (index.trades.length > 0 && hasPlots) buildTrade();
    if (document.getElementById("claim-view")) buildClaims();
    document.addEventListener("click", (event) => {
        const link = event.target.closest("a.jump");
        if (link && !link.hash.includes("=")) document.querySelector(link.hash)?.setAttribute("open", "");
        if (!link || !link.hash.includes("=")) return;
        event.preventDefault();
        history.pushState(null, "", link.hash);
        follow();
        scrollToSubject(link.hash);
    });
    for (const link of document.querySelectorAll("a[data-view]"))
        link.href = `#${link.dataset.view}`;  // without scripts they lead to its table and pictures
    addEventListener("popstate", follow);  // of links and of the address, too: once, or what was not found is forgotten
    // On paper nothing can be opened.
    let closed = [];
    addEventListener("beforeprint", () => {
        closed = [...document.querySelectorAll("details:not([open])")];
        for (const part of closed) part.open = true;
    });
    addEventListener("afterprint", () => {
        for (const part of closed) part.open = false;
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    let waiting = 0;
    addEventListener("resize", () => {
        clearTimeout(waiting);
        waiting = setTimeout(redraw, 100);
    });
    // They stand open where no script can, and where there is nothing to look at but them.
    for (const part of document.querySelectorAll("details.part"))
        part.open = index.maps.length + index.sweeps.length === 0;
    settle();
    await (location.hash.includes("=") ? follow() : drawAll());
    document.documentElement.dataset.ready = String(Math.round(performance.now()));
}

start();
