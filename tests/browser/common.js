// What the checks of the page share.
"use strict";

const schoolbook = "#scene=near-benign&form=sphere.schoolbook&format=f32";
const stateOf = (page) => page.evaluate(() => ({...state }));
const settled = (page) => page.evaluate(() => new Promise((done) => setTimeout(done, 150)));
/** To six digits, and for ulps to a millionth: the page keeps t* - RN64(t*) as a float. */
const near = (a, b) => a === b || (Number.isNaN(a) && Number.isNaN(b)) || Math.abs(a - b) <= 1e-6 + 1e-6 * Math.abs(b);

/** What stands in an element's box on the page, in pixels. */
const boxOf = (page, selector) => page.$eval(selector, (e) => {
    const { left, right, top, bottom } = e.getBoundingClientRect();
    return { left, right, top, bottom };
});

module.exports = {
    boxOf,
    schoolbook,
    stateOf,
    settled,
    near
};
