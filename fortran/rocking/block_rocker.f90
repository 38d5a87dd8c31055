!> The rigid block on two toes (thesis Eqs 6.1 to 6.3; Housner 1963), also with unequal toes.
!>
!> With R the distance of the toe from the centre of mass and alpha its angle from the vertical,
!>    (I + m R^2) q'' + m R sin(alpha - q) (g + a_v) + side a_h m R cos(alpha - q) = 0;
!> the linear form of slender blocks writes alpha - q for the sine and 1 for the cosine.
module rocking_block_rocker
   use common_dense_step, only : dense_step
   use common_kinds, only : wp, gravity, pi
   use common_status, only : status_ok, status_invalid_argument
   use rocking_rocker, only : rocker, series_short, side_index
   use rocking_watch, only : joint_demand
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: block_rocker, block_rocker_new, block_parameters

   !> Length of the parameter list: form (0 nonlinear, 1 linear), mass [kg], inertia about the centre of
   !> mass [kg m^2], its height [m], distance of the right and of the left toe [m], restitution of the
   !> impacts after which the block rocks to +x and to -x, slope of the base up to the right [rad], on which
   !> height and distances are counted
   integer, parameter :: block_parameters = 9
   !> Terms of the series of the rate; the rotation has one more
   integer, parameter :: order = 8
   !> Terms below this share of the tolerance end the series: chattering magnifies the neglected terms
   real(wp), parameter :: negligible = 1.0e-3_wp
   real(wp), parameter :: inverse(order + 1) = [1.0_wp, 1.0_wp / 2.0_wp, 1.0_wp / 3.0_wp, 1.0_wp / 4.0_wp, &
      1.0_wp / 5.0_wp, 1.0_wp / 6.0_wp, 1.0_wp / 7.0_wp, 1.0_wp / 8.0_wp, 1.0_wp / 9.0_wp]

   type, extends(rocker) :: block_rocker
      logical :: linear = .false.
      real(wp) :: alpha(2) = 0.0_wp    !! angle of the toe's ray from the vertical [rad]
      real(wp) :: moment(2) = 0.0_wp   !! m R [kg m]
      real(wp) :: inertia(2) = 0.0_wp  !! about the toe [kg m^2]
      real(wp) :: ratio(2) = 0.0_wp    !! of both, p^2 / g [1/m]
   contains
      procedure :: coefficients
      procedure :: potential
      procedure :: series_step
      procedure :: glide_samples
   end type block_rocker

   !> Terms of rotation and of rate times step length, in powers of the fraction of the step
   type :: power_series
      real(wp) :: x(0:order + 1)
      real(wp) :: u(0:order + 1)
      integer :: last    !! of u; x has one more
      real(wp) :: error  !! estimate over tolerance
   end type power_series

contains

   !> Set up from the flat parameter list of the facades
   subroutine block_rocker_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)  !! see block_parameters
      type(block_rocker), intent(out) :: body
      integer(c_int), intent(out) :: status
      real(wp) :: radius(2)

      status = status_invalid_argument
      if (size(parameters) < block_parameters) return
      if (any(parameters(2:6) <= 0.0_wp)) return
      if (any(parameters(7:8) < 0.0_wp) .or. any(parameters(7:8) > 1.0_wp)) return
      associate (mass => parameters(2), inertia => parameters(3), height => parameters(4), toe => parameters(5:6))
         radius = hypot(toe, height)
         body%linear = parameters(1) > 0.5_wp
         body%alpha = atan2(toe, height) + parameters(9) * [1.0_wp, -1.0_wp]
         body%moment = mass * radius
         body%inertia = inertia + mass * radius**2
         body%ratio = body%moment / body%inertia
      end associate
      if (any(body%alpha <= 0.0_wp) .or. any(body%alpha >= 0.5_wp * pi)) return  ! it slopes more than the block stands
      body%restitution = parameters(7:8)
      body%critical = body%alpha
      ! As far beyond the balance as rest is short of it, and not below the ground.
      body%limit = min(2.0_wp * body%alpha, 0.5_wp * pi)
      body%has_series = .true.
      call body%set_rest_rate()
      status = status_ok
   end subroutine block_rocker_new

   pure subroutine coefficients(model, side, q, m, half_dm, dv, dh, closed)
      class(block_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp), intent(out) :: m
      real(wp), intent(out) :: half_dm
      real(wp), intent(out) :: dv
      real(wp), intent(out) :: dh
      logical, intent(out) :: closed
      integer :: i
      i = side_index(side)
      m = model%inertia(i)
      half_dm = 0.0_wp
      if (model%linear) then
         dv = gravity * model%moment(i) * (model%alpha(i) - q)
         dh = model%moment(i)
      else
         dv = gravity * model%moment(i) * sin(model%alpha(i) - q)
         dh = model%moment(i) * cos(model%alpha(i) - q)
      end if
      closed = .true.
   end subroutine coefficients

   pure function potential(model, side, q) result(v)
      class(block_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp) :: v
      integer :: i
      i = side_index(side)
      if (model%linear) then
         v = gravity * model%moment(i) * q * (model%alpha(i) - 0.5_wp * q)
      else
         ! cos(alpha - q) - cos(alpha) without cancellation
         v = 2.0_wp * gravity * model%moment(i) * sin(model%alpha(i) - 0.5_wp * q) * sin(0.5_wp * q)
      end if
   end function potential

   !> One step by its Taylor series
   pure subroutine series_step(model, side, h, q, v, value, slope, tolerance, step)
      class(block_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: h
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      real(wp), intent(in) :: value(2)
      real(wp), intent(in) :: slope(2)
      real(wp), intent(in) :: tolerance(3)
      type(dense_step), intent(inout) :: step
      type(power_series) :: series
      call expand_series(model, side_index(side), real(side, wp), h, q, v, value, slope, tolerance, series)
      call take_over(series, h, series_end(series%x, series%last + 1), &
         series_end(series%u, series%last) * (1.0_wp / h), step)
   end subroutine series_step

   !> A series as a step
   pure subroutine take_over(series, h, q_end, v_end, step)
      type(power_series), intent(in) :: series
      real(wp), intent(in) :: h                !! length [s]
      real(wp), intent(in) :: q_end            !! state at the end
      real(wp), intent(in) :: v_end
      type(dense_step), intent(inout) :: step  !! t is left alone
      real(wp) :: per_h
      integer :: k
      per_h = 1.0_wp / h
      step%h = h
      step%q = q_end
      step%v = v_end
      step%a = 0.0_wp
      step%error = series%error
      step%degree = series%last + 1
      do k = 0, series%last
         step%cq(k) = series%x(k)
         step%cv(k) = series%u(k) * per_h
      end do
      step%cq(series%last + 1) = series%x(series%last + 1)
      step%cv(series%last + 1) = 0.0_wp
   end subroutine take_over

   !> Sample after sample by the same series, with no more than the comparisons that decide where to stop
   pure subroutine glide_samples(model, side, start, spacing, scale, samples, first, last, tolerance, q, v, passed, &
                         step, stopped, demand)
      class(block_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: start
      real(wp), intent(in) :: spacing
      real(wp), intent(in) :: scale
      real(wp), intent(in) :: samples(:, :)
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: tolerance(3)
      real(wp), intent(inout) :: q
      real(wp), intent(inout) :: v
      integer, intent(out) :: passed
      type(dense_step), intent(inout) :: step
      logical, intent(out) :: stopped
      type(joint_demand), intent(inout) :: demand
      type(joint_demand) :: found
      type(power_series) :: series
      real(wp) :: value(2), slope(2), begin, h, q_end, v_end, sigma
      integer :: c, i, k
      logical :: watched, calm

      passed = 0
      stopped = .false.
      watched = allocated(model%watch)
      i = side_index(side)
      sigma = real(side, wp)
      value = 0.0_wp
      slope = 0.0_wp
      do k = first, last
         begin = start + real(k - 1, wp) * spacing
         h = (start + real(k, wp) * spacing) - begin
         do c = 1, size(samples, 1)
            value(c) = scale * samples(c, k)
            slope(c) = scale * (samples(c, k + 1) - samples(c, k)) / spacing
         end do
         call expand_series(model, i, sigma, h, q, v, value, slope, tolerance, series)
         q_end = series_end(series%x, series%last + 1)
         v_end = series_end(series%u, series%last) * (1.0_wp / h)
         ! A turning point, an impact, a collapse, or a step that is too long: the general integrator resolves it
         stopped = series%error > series_short .or. q_end <= 0.0_wp .or. q_end >= model%limit(i) &
            .or. v * v_end <= 0.0_wp
         if (stopped) then
            step%t = begin
            call take_over(series, h, q_end, v_end, step)
            exit
         end if
         calm = .not. watched
         if (watched) calm = model%watch%changes_nothing(i, q_end, v_end, value(1) + slope(1) * spacing, &
            value(2) + slope(2) * spacing, demand)
         if (.not. calm) then
            found = demand
            call model%watch%check_demand(i, q_end, v_end, value(1) + slope(1) * spacing, value(2) + slope(2) * spacing, &
               [real(wp) ::], begin + h, found)
            ! Where a condition fails first, the general integrator finds the time
            stopped = (found%slips_at >= 0.0_wp .and. demand%slips_at < 0.0_wp) .or. (found%leaves_at >= 0.0_wp &
               .and. demand%leaves_at < 0.0_wp)
            if (stopped) then
               step%t = begin
               call take_over(series, h, q_end, v_end, step)
               exit
            end if
            demand = found
         end if
         q = q_end
         v = v_end
         passed = passed + 1
      end do
   end subroutine glide_samples

   !> Taylor series in the fraction of the step. Sine and cosine of alpha - q follow their own recurrences
   !> (S' = -C q', C' = S q'), so one evaluation of each serves the whole step.
   pure subroutine expand_series(model, i, sigma, h, q, v, value, slope, tolerance, series)
      type(block_rocker), intent(in) :: model
      integer, intent(in) :: i             !! of the side
      real(wp), intent(in) :: sigma        !! +1 or -1: the side
      real(wp), intent(in) :: h            !! see series_step of rocking_rocker
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      real(wp), intent(in) :: value(2)
      real(wp), intent(in) :: slope(2)
      real(wp), intent(in) :: tolerance(3)
      type(power_series), intent(out) :: series
      real(wp) :: s(0:order - 1), c(0:order - 1)
      real(wp) :: pull, push, pull_slope, push_slope, factor, rise, fall, tolerance_q, tolerance_u
      integer :: j, k

      associate (x => series%x, u => series%u, last => series%last)
         ! u is h v, so that q_k = u_(k-1)/k; the right-hand side is scaled by h^2
         factor = h * h * model%ratio(i)
         pull = factor * (gravity + value(2))
         pull_slope = factor * h * slope(2)
         push = factor * sigma * value(1)
         push_slope = factor * h * sigma * slope(1)
         x(0) = q
         u(0) = h * v
         x(1) = u(0)
         if (model%linear) then
            s(0) = model%alpha(i) - q
            c(0) = 1.0_wp
         else
            s(0) = sin(model%alpha(i) - q)
            c(0) = cos(model%alpha(i) - q)
         end if
         u(1) = -(pull * s(0) + push * c(0))
         x(2) = 0.5_wp * u(1)
         tolerance_q = tolerance(1) + tolerance(3) * abs(q)
         tolerance_u = h * tolerance(2) + tolerance(3) * abs(u(0))
         last = order
         series%error = 0.0_wp
         do k = 1, order - 1
            if (model%linear) then
               s(k) = -x(k)
               c(k) = 0.0_wp
            else
               select case (k)  ! the first convolutions, which every step needs, without a loop
               case (1)
                  rise = s(0) * u(0)
                  fall = c(0) * u(0)
               case (2)
                  rise = s(0) * u(1) + s(1) * u(0)
                  fall = c(0) * u(1) + c(1) * u(0)
               case (3)
                  rise = s(0) * u(2) + s(1) * u(1) + s(2) * u(0)
                  fall = c(0) * u(2) + c(1) * u(1) + c(2) * u(0)
               case default
                  rise = 0.0_wp
                  fall = 0.0_wp
                  do j = 0, k - 1
                     rise = rise + s(j) * u(k - 1 - j)
                     fall = fall + c(j) * u(k - 1 - j)
                  end do
               end select
               s(k) = -inverse(k) * fall
               c(k) = inverse(k) * rise
            end if
            u(k + 1) = -inverse(k + 1) * (pull * s(k) + pull_slope * s(k - 1) + push * c(k) + push_slope * c(k - 1))
            x(k + 2) = inverse(k + 2) * u(k + 1)
            if (k < 2) cycle
            ! The last two terms bound the neglected ones, which are much smaller.
            if (abs(u(k + 1)) + abs(u(k)) <= negligible * tolerance_u .and. &
                abs(x(k + 2)) + abs(x(k + 1)) <= negligible * tolerance_q) then
               last = k + 1
               return  ! with an error that counts for nothing
            end if
         end do
         series%error = max((abs(x(last + 1)) + abs(x(last))) / tolerance_q, &
            (abs(u(last)) + abs(u(last - 1))) / tolerance_u)
      end associate
   end subroutine expand_series

   !> Value at the end of the step: the sum of the terms 0 to last, small ones first
   pure function series_end(terms, last) result(total)
      real(wp), intent(in) :: terms(0:order + 1)
      integer, intent(in) :: last
      real(wp) :: total
      integer :: k
      total = terms(last)
      do k = last - 1, 0, -1
         total = total + terms(k)
      end do
   end function series_end

end module rocking_block_rocker
