// `wmrgen view` writes another version into version.js beside this page when a robot file is saved.
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
