{
  const text = id => document.getElementById(id).textContent;
  DwellPage.unpack(text('page-numbers')).then(numbers => {
    const page = DwellPage.create(document.getElementById('page'));
    page.show(text('page-description'), numbers);
    document.documentElement.dataset.ready = 'yes';
    window.dwellPage = page;
  });
}
