// What is folded opens on paper where it is to be printed, for links into it,
// and closes again after printing. Tables that are wider than their box say so.

let opened = [];
addEventListener('beforeprint', () => {
  opened = all('details.printed:not([open])');
  for (const fold of opened) fold.open = true;
});
addEventListener('afterprint', () => {
  for (const fold of opened) fold.open = false;
});

const openAround = () => {
  let id = location.hash.slice(1);
  try {
    id = decodeURIComponent(id);
  } catch (error) {
    // No name of ours then: nothing to open.
  }
  const target = id && document.getElementById(id);
  const fold = target && target.closest('details');
  if (fold) fold.open = true;
};
addEventListener('hashchange', openAround);
openAround();

const boxes = new ResizeObserver((entries) => {
  for (const {target} of entries) {
    target.parentElement.classList.toggle(
        'wider', target.scrollWidth > target.clientWidth + 1);
  }
});
for (const box of all('.scroll')) boxes.observe(box);
