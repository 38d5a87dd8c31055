!> Linear oscillators under a sampled ground motion joined by straight lines: no error of integration.
!>
!> u'' + 2 z w u' + w^2 u = -a(t). Over a step h the solution is a matrix times (u, u', a0, a1) (Nigam and
!> Jennings 1969). Their closed forms for the load lose digits as (w h)^-3; here the two load integrals are
!> taken by Gauss quadrature, which is exact to rounding because a step is at most a twentieth of a period.
module motion_oscillator
   use, intrinsic :: iso_c_binding, only : c_int
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp, pi
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_out_of_memory
   use motion_c_bindings, only : extrados_oscillator_lanes
   implicit none
   private
   public :: response_spectra, oscillator_history, substeps

   !> Oscillators advanced side by side, as in c/quake/oscillator.c
   integer, parameter :: lanes = 8
   !> Steps of a block between looks at the cancel flag
   integer, parameter :: chunk = 500000
   !> Shortest period is step * most_substeps / points_per_cycle
   integer, parameter :: most_substeps = 4096
   !> Points of the half cycle after a motion's end; of so many the greatest misses the peak by 1e-12 of it at most
   integer, parameter :: most_tail = 1000000
   !> Nodes and weights of eight-point Gauss quadrature on (0, 1)
   real(wp), parameter :: node(8) = 0.5_wp + 0.5_wp * [ &
      -0.96028985649753623168_wp, -0.79666647741362673959_wp, -0.52553240991632898582_wp, &
      -0.18343464249564980494_wp, 0.18343464249564980494_wp, 0.52553240991632898582_wp, &
      0.79666647741362673959_wp, 0.96028985649753623168_wp]
   real(wp), parameter :: weight(8) = 0.5_wp * [ &
      0.10122853629037625915_wp, 0.22238103445337447054_wp, 0.31370664587788728734_wp, &
      0.36268378337836198297_wp, 0.36268378337836198297_wp, 0.31370664587788728734_wp, &
      0.22238103445337447054_wp, 0.10122853629037625915_wp]

   !> One exact step: (u, v) <- (uu u + uv v + u0 a0 + u1 a1, vu u + vv v + v0 a0 + v1 a1)
   type :: transition
      real(wp) :: uu, uv, u0, u1, vu, vv, v0, v1
   end type transition

contains

   !> Parts into which a sampling step is cut, a power of two, so that a period has enough points;
   !> 0 if the period is too short for this sampling
   elemental function substeps(period, step, points_per_cycle) result(m)
      real(wp), intent(in) :: period             !! [s]
      real(wp), intent(in) :: step               !! [s]
      integer(c_int), intent(in) :: points_per_cycle
      integer :: m
      m = 1
      do while (period * real(m, wp) < real(points_per_cycle, wp) * step .and. m <= most_substeps)
         m = 2 * m
      end do
      if (m > most_substeps) m = 0
   end function substeps

   !> The exact step of length h
   pure function make_transition(period, damping, h) result(t)
      real(wp), intent(in) :: period      !! undamped [s]
      real(wp), intent(in) :: damping     !! ratio, 0 <= damping < 1
      real(wp), intent(in) :: h           !! [s]
      type(transition) :: t
      real(wp) :: w, wd, e, s, c, early, late
      integer :: k

      w = 2.0_wp * pi / period
      wd = w * sqrt(1.0_wp - damping**2)
      e = exp(-damping * w * h)
      s = e * sin(wd * h)
      c = e * cos(wd * h)
      ! of the unit impulse response g: early = int g(s) s/h ds belongs to a0, late = int g(s) (1 - s/h) ds to a1
      early = 0.0_wp
      late = 0.0_wp
      do k = 1, size(node)
         associate (x => h * node(k))
            early = early + weight(k) * node(k) * exp(-damping * w * x) * sin(wd * x)
            late = late + weight(k) * (1.0_wp - node(k)) * exp(-damping * w * x) * sin(wd * x)
         end associate
      end do
      t%uu = c + damping * w / wd * s
      t%uv = s / wd
      t%vu = -w**2 / wd * s
      t%vv = c - damping * w / wd * s
      t%u0 = -early * h / wd
      t%u1 = -late * h / wd
      ! v = int g'(s) a(h - s) ds by parts: g(h) a0 plus the mean of g times (a1 - a0)
      t%v0 = -(s - (early + late)) / wd
      t%v1 = -(early + late) / wd
   end function make_transition

   !> Greatest |u|, |u'| and |u'' + a| of every oscillator for every motion, free vibration after the
   !> motion's end included
   subroutine response_spectra(motions, step, period, damping, points_per_cycle, threads, peak, status)
      real(wp), intent(in), contiguous :: motions(:, :)        !! (points, count) [m/s^2]
      real(wp), intent(in) :: step                             !! [s]
      real(wp), intent(in), contiguous :: period(:)            !! [s]
      real(wp), intent(in), contiguous :: damping(:)           !! ratios
      integer(c_int), intent(in) :: points_per_cycle           !! least number of points on a period
      integer(c_int), intent(in) :: threads
      real(wp), intent(out), contiguous :: peak(:, :, :, :)    !! (3, periods, dampings, count) [m, m/s, m/s^2]
      integer(c_int), intent(out) :: status
      integer, allocatable :: order(:), parts(:)
      integer(c_int), allocatable :: fate(:, :)
      integer :: blocks, b, k, m, filled, count, stat, first(2)

      peak = 0.0_wp
      status = status_invalid_argument
      if (threads < 1 .or. points_per_cycle < 20 .or. .not. step > 0.0_wp .or. size(motions, 1) < 1) return
      if (any(.not. period > 0.0_wp) .or. any(.not. (damping >= 0.0_wp .and. damping < 1.0_wp))) return
      if (any(substeps(period, step, points_per_cycle) == 0)) return
      count = size(motions, 2)

      ! Blocks of oscillators with equal numbers of substeps; order holds 0 where a block is not full
      status = status_out_of_memory
      allocate (order(lanes * (size(period) * size(damping) / lanes + 16)), &
         parts(size(period) * size(damping) / lanes + 16), stat=stat)
      if (stat /= 0) return
      order = 0
      blocks = 0
      m = 1
      do while (m <= most_substeps)
         filled = lanes
         do k = 1, size(period) * size(damping)
            if (substeps(period(mod(k - 1, size(period)) + 1), step, points_per_cycle) /= m) cycle
            if (filled == lanes) then
               blocks = blocks + 1
               parts(blocks) = m
               filled = 0
            end if
            filled = filled + 1
            order(lanes * (blocks - 1) + filled) = k
         end do
         m = 2 * m
      end do
      allocate (fate(blocks, count), stat=stat)
      if (stat /= 0) return

      fate = status_cancelled
      !$omp parallel do collapse(2) schedule(dynamic) default(none) num_threads(threads) private(k, b, first) &
      !$omp shared(count, blocks, order, parts, motions, step, period, damping, peak, fate)
      do k = 1, count
         do b = 1, blocks
            if (cancel_requested()) cycle
            first = [lanes * (b - 1) + 1, lanes * b]
            call advance_block(motions(:, k), step, parts(b), order(first(1):first(2)), period, damping, &
               peak(:, :, :, k), fate(b, k))
         end do
      end do
      !$omp end parallel do
      status = status_ok
      if (size(fate) > 0) status = maxval(fate)
   end subroutine response_spectra

   !> One block of oscillators through one motion
   subroutine advance_block(a, step, parts, member, period, damping, peak, status)
      real(wp), intent(in), contiguous :: a(:)             !! [m/s^2]
      real(wp), intent(in) :: step                         !! [s]
      integer, intent(in) :: parts                         !! substeps
      integer, intent(in) :: member(lanes)                 !! number in (periods, dampings), 0 none
      real(wp), intent(in), contiguous :: period(:)        !! [s]
      real(wp), intent(in), contiguous :: damping(:)
      real(wp), intent(inout), contiguous :: peak(:, :, :) !! (3, periods, dampings)
      integer(c_int), intent(out) :: status
      real(wp) :: coefficient(lanes, 10)                   !! in the order of c/quake/oscillator.c
      real(wp) :: state(lanes, 2)                          !! u [m], u' [m/s]
      real(wp) :: most(lanes, 3)                           !! |u|, |u'|, |u'' + a|
      real(wp) :: h, w, new, half
      integer :: i, j, l, jp, jd, points, tail
      type(transition) :: t

      h = step / real(parts, wp)
      state = 0.0_wp
      most = 0.0_wp
      do l = 1, lanes
         jp = mod(max(member(l), 1) - 1, size(period)) + 1
         jd = (max(member(l), 1) - 1) / size(period) + 1
         t = make_transition(period(jp), damping(jd), h)
         w = 2.0_wp * pi / period(jp)
         coefficient(l, :) = [t%uu, t%uv, t%u0, t%u1, t%vu, t%vv, t%v0, t%v1, w**2, 2.0_wp * damping(jd) * w]
      end do
      status = status_ok
      do i = 1, size(a) - 1, chunk / parts + 1
         if (cancel_requested()) then
            status = status_cancelled
            return
         end if
         points = min(chunk / parts + 2, size(a) - i + 1)
         call extrados_oscillator_lanes(int(points, c_int), a(i:), int(parts, c_int), coefficient, state, most)
      end do
      ! Half a cycle of free vibration holds the greatest values that can still come
      do l = 1, lanes
         if (member(l) == 0) cycle
         jp = mod(member(l) - 1, size(period)) + 1
         jd = (member(l) - 1) / size(period) + 1
         half = 0.5_wp * period(jp) / sqrt(1.0_wp - damping(jd)**2)
         tail = ceiling(min(half / h, real(most_tail, wp)))
         t = make_transition(period(jp), damping(jd), max(h, half / real(most_tail, wp)))
         associate (u => state(l, 1), v => state(l, 2), c => coefficient(l, :))
            do j = 1, tail
               new = t%uu * u + t%uv * v
               v = t%vu * u + t%vv * v
               u = new
               most(l, :) = max(most(l, :), [abs(u), abs(v), abs(c(9) * u + c(10) * v)])
            end do
         end associate
         peak(:, jp, jd) = most(l, :)
      end do
   end subroutine advance_block

   !> Displacement and velocity of one oscillator relative to the ground at every sample, from rest
   pure subroutine oscillator_history(a, step, period, damping, points_per_cycle, u, v, status)
      real(wp), intent(in), contiguous :: a(:)             !! [m/s^2]
      real(wp), intent(in) :: step                         !! [s]
      real(wp), intent(in) :: period                       !! [s]
      real(wp), intent(in) :: damping                      !! ratio
      integer(c_int), intent(in) :: points_per_cycle
      real(wp), intent(out), contiguous :: u(:)            !! [m]
      real(wp), intent(out), contiguous :: v(:)            !! [m/s]
      integer(c_int), intent(out) :: status
      type(transition) :: t
      real(wp) :: x, y, new, rise, p0, p1
      integer :: i, j, m

      u = 0.0_wp
      v = 0.0_wp
      status = status_invalid_argument
      if (.not. (period > 0.0_wp .and. step > 0.0_wp .and. damping >= 0.0_wp .and. damping < 1.0_wp)) return
      if (points_per_cycle < 20 .or. size(a) < 1) return
      m = substeps(period, step, points_per_cycle)
      if (m == 0) return
      status = status_ok
      t = make_transition(period, damping, step / real(m, wp))
      x = 0.0_wp
      y = 0.0_wp
      do i = 1, size(a) - 1
         rise = (a(i + 1) - a(i)) / real(m, wp)
         do j = 1, m
            p0 = a(i) + real(j - 1, wp) * rise
            p1 = a(i) + real(j, wp) * rise
            new = (t%uu * x + t%uv * y) + (t%u0 * p0 + t%u1 * p1)
            y = (t%vu * x + t%vv * y) + (t%v0 * p0 + t%v1 * p1)
            x = new
         end do
         u(i + 1) = x
         v(i + 1) = y
      end do
   end subroutine oscillator_history

end module motion_oscillator
