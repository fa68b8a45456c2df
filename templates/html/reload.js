// `wmrgen view` writes a new version number to version.js next to this page when a robot file is saved.
setInterval(() => {
  const script = document.createElement("script");
  script.onload = () => {
    script.remove();
    if (window.wmrgenVersion !== VERSION) location.reload();
  };
  script.onerror = () => script.remove();
  script.src = "version.js?" + Date.now();
  document.head.append(script);
}, 500);
