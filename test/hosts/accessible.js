// Functions that accessible.py calls on a page, after the script of axe.
"use strict";
{
  const k_rules = { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] };
  const channels_of = (colour) => colour.match(/[\d.]+/g).map(Number);
  const linear = (x) => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r / 255) + 0.7152 * linear(g / 255) + 0.0722 * linear(b / 255);
  function background_of(element) {
    const colour = element ? channels_of(getComputedStyle(element).backgroundColor) : [255, 255, 255];
    return colour[3] === 0 ? background_of(element.parentElement) : colour;
  }
  window.accessible = {
    // Violations (rule, severity, elements), the number of rules that hold, and rules that could not judge some elements.
    async violations() {
      const { violations, passes, incomplete } = await axe.run(k_rules);
      return [violations.map(({ id, impact, nodes }) => [id, impact, nodes.map(({ html }) => html.slice(0, 120))]), passes.length,
        incomplete.map(({ id, nodes }) => [id, nodes.length])];
    },
    // The contrast of each text of charts with the page, the least first. Axe does not determine their background.
    contrasts: () => [...document.querySelectorAll("svg text")].map((text) => {
      const colours = [channels_of(getComputedStyle(text).fill), background_of(text)];
      const [low, high] = colours.map(luminance).sort((a, b) => a - b);
      return [(high + 0.05) / (low + 0.05), text.textContent.slice(0, 40)];
    }).sort(([a], [b]) => a - b),
    // Shows the first ready material, if there is one.
    async show_ball() {
      const ball = document.querySelector("#gallery li a");
      ball?.click();
      while (ball && document.getElementById("editing").hidden) await new Promise((done) => setTimeout(done, 100));
      return ball !== null;
    },
  };
}
