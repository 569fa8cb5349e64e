// Assembles the page, follows links inside it, and marks when it is ready.

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

async function start() {
    document.querySelector("header").append(make("p", { id: "note", hidden: true, role: "status" }));
    if (index.maps.length > 0) {
        buildMaps();
        buildPanes();
    }
    if (index.sweeps.length > 0) buildSweeps();
    if (index.trades.length > 0) buildTrade();
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
        link.href = `#${link.dataset.view}`;  // without scripts these links lead to the table and pictures
    // Also fires for links and typed addresses. Following a link twice would forget what was not found.
    addEventListener("popstate", follow);
    // Nothing can be opened on paper, so open everything before printing.
    let closed = [];
    addEventListener("beforeprint", () => {
        closed = [...document.querySelectorAll("details:not([open])")];
        for (const part of closed) part.open = true;
    });
    addEventListener("afterprint", () => {
        for (const part of closed) part.open = false;
    });
    let waiting = 0;
    addEventListener("resize", () => {
        clearTimeout(waiting);
        waiting = setTimeout(() => goTo({}), 100);
    });
    // These parts are open without scripts. With scripts they are open only if the page has nothing else to show.
    for (const part of document.querySelectorAll("details.part"))
        part.open = index.maps.length + index.sweeps.length === 0;
    settle();
    await (location.hash.includes("=") ? follow() : drawAll());
    document.documentElement.dataset.ready = String(Math.round(performance.now()));
}

start();
