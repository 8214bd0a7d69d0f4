/* Which rules of the web content guidelines (WCAG 2.1, AA) this page breaks, and where. */
() => {
  const said = [], all = (what) => [...document.querySelectorAll(what)];
  const say = (rule, item) => said.push(`${rule}: ${item.outerHTML.slice(0, 90)}`);
  const name = (item) => (item.getAttribute('aria-label') || (item.getAttribute('aria-labelledby') || '').split(' ').map((id) => document.getElementById(id)?.textContent || '').join(' ')
    || item.closest('label')?.textContent || item.textContent || item.title || '').trim();
  const labelled = (item) => (item.getAttribute('aria-label') || [...(item.getAttribute('aria-labelledby') || '').split(' ')]
    .map((id) => document.getElementById(id)?.textContent || '').join(' ')).trim();
  const hidden = (item) => item.closest('[aria-hidden=true], noscript, script, [hidden]') || !item.getClientRects().length;
  if (!document.documentElement.lang) say('the page has a language', document.documentElement);
  if (!document.title.trim()) say('the page has a title', document.head);
  for (const [what, least, most] of [['main', 1, 1], ['h1', 1, 1], ['header', 1, 1], ['footer', 1, 1], ['nav[aria-label]', 1, 9]]) {
    const count = all(what).length;
    if (count < least || count > most) say(`${what}: ${count} of them`, document.body);
  }
  for (const item of document.body.children) {
    if (!item.matches('header, main, footer, script, noscript, a.skip') && !hidden(item)) say('everything stands in a landmark', item);
  }
  let level = 0;
  for (const item of all('h1, h2, h3, h4, h5, h6').filter((each) => !hidden(each))) {
    const own = Number(item.tagName[1]);
    if (own > level + 1) say('no level of heading is skipped', item);
    if (!item.textContent.trim()) say('a heading has words', item);
    level = own;
  }
  for (const item of all('button, a[href], select, input, textarea, [role=button], summary').filter((each) => !hidden(each))) if (!name(item)) say('a control has a name', item);
  for (const item of all('img:not([alt]), svg:not([aria-hidden=true]):not([role=img]), canvas:not([role=img])').filter((each) => !hidden(each))) say('a picture has a role', item);
  for (const item of all('[role^=graphics], svg [role]').filter((each) => !hidden(each))) if (!labelled(item) && !item.querySelector(':scope > title')) say('a sign of a picture has a name', item);
  for (const item of all('[role=img], [role=region], [role=group]')) if (!labelled(item)) say('a picture or group has a name', item);
  for (const item of all('[role=img]')) if (item.querySelector('a, button, input, select, [tabindex]')) say('a picture holds no controls', item);
  for (const item of all('table')) {
    if (!item.querySelector('thead th, tbody th')) say('a table has headers', item);
    if (!item.querySelector('caption') && !item.closest('[aria-label]')) say('a table has a name', item);
    for (const cell of item.querySelectorAll('th')) if (!cell.scope || !cell.textContent.trim()) say('a header has a scope and words', cell);
  }
  for (const item of all('.scroll, pre').filter((each) => each.scrollWidth > each.clientWidth + 1 && !hidden(each))) if (item.tabIndex < 0) say('what scrolls can be reached', item);
  for (const item of all('a[href^="#"]')) if (!document.getElementById(item.hash.slice(1))) say('a link leads somewhere', item);
  for (const item of all('ul, ol')) for (const child of item.children) if (child.tagName !== 'LI') say('a list holds items', item);
  for (const item of all('dl')) for (const child of item.children) if (!child.matches('div, dt, dd')) say('a list of terms holds terms', item);
  for (const item of all('[tabindex]')) if (Number(item.tabIndex) > 0) say('nothing jumps the queue', item);
  for (const item of all('button, select').filter((each) => !hidden(each) && !each.closest('.live'))) { const box = item.getBoundingClientRect(); if (Math.min(box.width, box.height) < 24) say('a target is 24 px wide', item); }
  const words = document.createTreeWalker(document.querySelector('main') || document.body, NodeFilter.SHOW_TEXT);
  while (words.nextNode()) if (/\d (%|mm|cm|m|kg|g|s|rad)(?![\w/])/.test(words.currentNode.nodeValue) && !words.currentNode.parentElement.closest('pre, code, script, svg, .chart, .replay')) say('a number keeps its unit', words.currentNode.parentElement);
  const ids = all('[id]').filter((each) => !each.closest('.live')).map((each) => each.id);
  for (const id of ids.filter((each, k) => ids.indexOf(each) !== k)) said.push(`an id stands once: ${id}`);
  return said;
}
