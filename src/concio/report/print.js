/* paper shows what is folded on the screen */
(() => {
  "use strict";
  let folded = [];
  const open = () => { folded = [...document.querySelectorAll("details:not([open]):not(.log)")]; folded.forEach((d) => { d.open = true; }); };
  const close = () => { folded.forEach((d) => { d.open = false; }); folded = []; };
  addEventListener("beforeprint", open); addEventListener("afterprint", close);
})();
