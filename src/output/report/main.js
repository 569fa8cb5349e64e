// Puts the parts together, follows links inside the page and says when it is ready.

function follow() {
    if (!readHash(location.hash)) return Promise.resolve();
    const note = document.getElementById("note");
    note.hidden = notes.length === 0;
    note.textContent = notes.join("; ");
    return look({});
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
    if (index.sweeps.length > 0 && hasPlots) buildSweeps();
    if (index.trades.length > 0 && hasPlots) buildTrade();
    if (document.getElementById("claim-view")) buildClaims();
    document.addEventListener("click", (event) => {
        const link = event.target.closest("a.jump");
        if (!link || !link.hash.includes("=")) return;
        event.preventDefault();
        history.pushState(null, "", link.hash);
        follow();
        scrollToSubject(link.hash);
    });
    addEventListener("popstate", follow);
    addEventListener("hashchange", follow);
    for (const part of document.querySelectorAll("details.part")) part.open = false;  // they stand open where no script can
    settle();
    if (location.hash.includes("=")) await follow();
    else await Promise.all(listeners.map((show) => show([])));
    document.documentElement.dataset.ready = String(Math.round(performance.now()));
}

start();
