% Draws the forced responses of a run as exported by `isola export RUN --format mat`, in MATLAB and Octave:
%
%   redraw FOLDER response.png
function redraw(folder, picture)
  run = load(fullfile(folder, 'run.mat'));
  window = figure('visible', 'off');
  hold on
  colors = copper(numel(run.levels.amplitude));
  labels = {};
  for i = 1:numel(run.branches.file)
    file = fullfile(folder, 'branches', [run.branches.file{i} '.mat']);
    if ~exist(file, 'file')  % run.run.missing says why
      continue
    end
    branch = load(file);
    points = 1:numel(branch.omega);
    if branch.closed
      points = [points 1];
    end
    style = '-';
    if ~strcmp(branch.kind, 'main')
      style = '--';
    end
    color = colors(strcmp(run.levels.amplitude, branch.level), :);
    plot(branch.omega(points), 1e3 * branch.amplitude(points, 1), style, 'color', color);
    labels{end + 1} = ['A = ' branch.level ', ' branch.kind];
  end
  if isfield(run, 'backbone')
    plot(run.backbone.omega, 1e3 * run.backbone.amplitude(:, 1), 'k:');
    labels{end + 1} = 'backbone';
  end
  title(run.run.name);
  xlabel('omega, rad/s');
  ylabel(['|' run.model.monitors{1} '|, mm']);
  legend(labels, 'location', 'eastoutside');
  print(window, picture, '-dpng', '-r120');
end
