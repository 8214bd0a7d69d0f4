// A number and its unit stay on one line; what may be copied as it stands (commands, scenes) keeps its blanks.
(() => {
  const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT, (node) =>
    node.parentElement.closest('pre, code, script, style, svg, .chart') ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT);
  const parted = /([\d⁰-⁹]) (?=(?:%|‰|°|[mck]?m|µm|m?s|rad|mrad|k?g|k?N|J|Hz)(?![\wÀ-ž/]))/g;
  while (words.nextNode()) words.currentNode.nodeValue = words.currentNode.nodeValue.replace(parted, '$1\u00a0');
})();
