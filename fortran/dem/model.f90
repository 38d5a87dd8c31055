!> A discrete-element model in motion: bodies, contacts and laws, advanced by leap-frog steps.
module dem_model
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_bodies, only : body, body_set, body_turn, load_moment
   use dem_clock, only : begin_step, end_step
   use dem_contacts, only : contact_pair, contact_set, overlap, measure_overlap, measure_springs, choose_edges
   use dem_crushing, only : crush_corners
   use dem_jointed, only : jointed_model
   use dem_law, only : apply_pair_law
   use dem_loading, only : move_rate
   use dem_ties, only : add_tie_stiffness, stretch_ties, trace_ties
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: block_model, advance_model, critical_step, prepare_step, predict_velocity, pull_ties, move_body, &
      finish_step

   type, extends(jointed_model) :: block_model
      type(body_set) :: set
      type(contact_set) :: contacts
      real(wp) :: gravity(2) = 0.0_wp          !! [m/s^2]
      real(wp) :: mass_damping = 0.0_wp        !! alpha [1/s]
      real(wp) :: pull(2) = 0.0_wp             !! body force of the last step [m/s^2]
      real(wp) :: pull_before(2) = 0.0_wp      !! and of the one before
      real(wp) :: base(2) = 0.0_wp             !! velocity of the ground [m/s], moving base only
      real(wp) :: base_before(2) = 0.0_wp      !! the same in the step before
      real(wp) :: base_place(2) = 0.0_wp       !! its displacement [m]
      ! Contacts without springs, see dem_moreau
      real(wp), allocatable :: ahead(:, :)     !! (5, bodies) where the old velocities lead to
      integer, allocatable :: number(:, :)     !! (2, pairs) of each contact point in the problem, 0: it cannot press
   end type block_model

contains

   !> Up to `count` steps; returns early where the contacts must be searched again
   subroutine advance_model(model, count, threads)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      if (threads > 1) then
         call advance_threads(model, count, threads)
      else
         call advance_alone(model, count)
      end if
   end subroutine advance_model

   subroutine advance_alone(model, count)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: count
      integer :: n, k
      do n = 1, count
         call prepare_step(model)
         do k = 1, size(model%set%item)
            call predict_velocity(model, model%set%item(k))
         end do
         do k = 1, model%contacts%pairs
            call act_pair(model, model%contacts%pair(k))
         end do
         call pull_ties(model)
         do k = 1, size(model%set%item)
            call move_body(model, model%set%item(k), model%stale)
         end do
         call finish_step(model)
         if (model%stale) return
      end do
   end subroutine advance_alone

   !> The same steps shared among threads: pairs of one colour touch no common body
   subroutine advance_threads(model, count, threads)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer :: n, k, c
      logical :: stale

      stale = .false.
      !$omp parallel default(none) num_threads(threads) shared(model, count, stale) private(n, k, c)
      do n = 1, count
         !$omp single
         call prepare_step(model)
         stale = .false.
         !$omp end single
         !$omp do schedule(static)
         do k = 1, size(model%set%item)
            call predict_velocity(model, model%set%item(k))
         end do
         !$omp end do
         do c = 1, model%contacts%colours - model%contacts%alone
            !$omp do schedule(static)
            do k = model%contacts%colour_first(c), model%contacts%colour_first(c + 1) - 1
               call act_pair(model, model%contacts%pair(k))
            end do
            !$omp end do
         end do
         !$omp single
         do c = model%contacts%colours - model%contacts%alone + 1, model%contacts%colours
            do k = model%contacts%colour_first(c), model%contacts%colour_first(c + 1) - 1
               call act_pair(model, model%contacts%pair(k))
            end do
         end do
         call pull_ties(model)
         !$omp end single
         !$omp do schedule(static) reduction(.or. : stale)
         do k = 1, size(model%set%item)
            call move_body(model, model%set%item(k), stale)
         end do
         !$omp end do
         !$omp single
         model%stale = stale
         call finish_step(model)
         !$omp end single
         if (model%stale) exit
      end do
      !$omp end parallel
   end subroutine advance_threads

   !> Body force and base velocity of this step
   subroutine prepare_step(model)
      type(block_model), intent(inout) :: model
      real(wp) :: ground(3)
      call begin_step(model%model_clock, ground)
      model%pull_before = model%pull
      model%pull = model%gravity
      model%base_before = model%base
      if (model%load%moving_base) then
         model%base = model%base + model%kick * ground(1:2)
      else
         model%pull = model%pull - ground(1:2)
      end if
   end subroutine prepare_step

   !> Velocity that follows from the forces of the last step; of the next ones it leaves the constant loads
   pure subroutine predict_velocity(model, b)
      type(block_model), intent(in) :: model
      type(body), intent(inout) :: b

      if (b%fixed) then
         call prescribe_support(model, b)
      else
         b%px = b%vx + model%kick * (b%fx * b%inverse_mass + model%pull(1))
         b%py = b%vy + model%kick * (b%fy * b%inverse_mass + model%pull(2))
         b%pspin = b%spin + model%kick * b%moment * b%inverse_inertia
         ! Work of the ground's part of the body force; gravity has a potential.
         b%work = b%work + 0.5_wp * model%drift * b%mass * &
            ((model%pull(1) + model%pull_before(1) - 2.0_wp * model%gravity(1)) * b%vx &
            + (model%pull(2) + model%pull_before(2) - 2.0_wp * model%gravity(2)) * b%vy)
      end if
      b%fx = b%load(1)
      b%fy = b%load(2)
      b%moment = load_moment(b)
      b%touched = .false.
   end subroutine predict_velocity

   !> Velocity of a support in the coming half step
   pure subroutine prescribe_support(model, b)
      type(block_model), intent(in) :: model
      type(body), intent(inout) :: b
      integer :: k
      real(wp) :: rate(3)
      rate = [model%base(1), model%base(2), 0.0_wp]
      if (model%shaking .and. model%waits == 0) then
         do k = 1, size(model%load%move)
            if (b%number == model%load%move(k)%body) rate = rate &
               + move_rate(model%load%move(k), model%t + 0.5_wp * model%step)
         end do
      end if
      b%px = rate(1)
      b%py = rate(2)
      b%pspin = rate(3)
   end subroutine prescribe_support

   !> Geometry and law of one pair
   pure subroutine act_pair(model, pair)
      type(block_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      type(overlap) :: now
      real(wp) :: distance
      if (pair%careful) call choose_edges(model%set, model%contacts%skin, pair, distance)
      associate (a => model%set%item(pair%bodies(1)), b => model%set%item(pair%bodies(2)))
         call measure_springs(pair, a, b, now)
         if (model%law(pair%law)%strength > 0.0_wp) call crush_corners(model%law(pair%law), pair, now)
         call apply_pair_law(model%law(pair%law), model%kick, model%drift, now, a, b, pair)
      end associate
   end subroutine act_pair

   !> Forces of the ties, added to the bodies: they are few
   pure subroutine pull_ties(model)
      type(block_model), intent(inout) :: model
      real(wp) :: rate(2)
      integer :: k
      if (size(model%ties%item) == 0) return
      call place_anchors(model)
      call stretch_ties(model%ties, merge(model%drift, 0.0_wp, model%shaking .and. .not. model%quasi_static))
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            rate = model%base_before
            if (one%body > 0) then
               associate (b => model%set%item(one%body))
                  b%fx = b%fx + one%force(1)
                  b%fy = b%fy + one%force(2)
                  b%moment = b%moment + (one%at(1) - b%x) * one%force(2) - (one%at(2) - b%y) * one%force(1)
                  if (.not. b%fixed) cycle
                  rate = [b%vx - b%spin * (one%at(2) - b%y), b%vy + b%spin * (one%at(1) - b%x)]
               end associate
            end if
            model%ties%support_work = model%ties%support_work &
               - 0.5_wp * model%drift * dot_product(one%force(1:2) + one%before(1:2), rate)
         end associate
      end do
   end subroutine pull_ties

   !> Where the anchors of the ties are
   pure subroutine place_anchors(model)
      type(block_model), intent(inout) :: model
      integer :: k
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            if (one%body == 0) then
               one%at = one%place + [model%base_place, 0.0_wp]
            else
               associate (b => model%set%item(one%body))
                  one%at = [b%x + b%c * one%place(1) - b%s * one%place(2), &
                     b%y + b%s * one%place(1) + b%c * one%place(2), 0.0_wp]
               end associate
            end if
         end associate
      end do
   end subroutine place_anchors

   !> Velocity and position after the step
   pure subroutine move_body(model, b, stale)
      type(block_model), intent(in) :: model
      type(body), intent(inout) :: b
      logical, intent(inout) :: stale
      real(wp) :: keep, gain

      if (b%fixed) then
         b%vx = b%px
         b%vy = b%py
         b%spin = b%pspin
      else
         keep = 1.0_wp
         gain = model%kick
         if (model%mass_damping > 0.0_wp) then
            b%mass_loss = b%mass_loss + model%drift * model%mass_damping * &
               (b%mass * (b%vx**2 + b%vy**2) + b%inertia * b%spin**2)
            gain = model%kick / (1.0_wp + 0.5_wp * model%mass_damping * model%kick)
            keep = (1.0_wp - 0.5_wp * model%mass_damping * model%kick) &
               / (1.0_wp + 0.5_wp * model%mass_damping * model%kick)
         end if
         b%vx = keep * b%vx + gain * (b%fx * b%inverse_mass + model%pull(1))
         b%vy = keep * b%vy + gain * (b%fy * b%inverse_mass + model%pull(2))
         b%spin = keep * b%spin + gain * b%moment * b%inverse_inertia
         if (.not. b%touched) then
            b%airborne = b%airborne + model%step
            if (b%touching) b%bounces = b%bounces + 1
         end if
         b%touching = b%touched
      end if
      b%x = b%x + model%step * b%vx
      b%y = b%y + model%step * b%vy
      if (abs(b%spin) > 0.0_wp) then
         b%angle = b%angle + model%step * b%spin
         call body_turn(b)
      end if
      if (abs(b%x - b%seen_x) + abs(b%y - b%seen_y) + b%radius * abs(b%angle - b%seen_angle) &
         > 0.5_wp * model%contacts%skin) stale = .true.
   end subroutine move_body

   !> Time goes on
   subroutine finish_step(model)
      type(block_model), intent(inout) :: model
      model%base_place = model%base_place + model%step * model%base
      call end_step(model%model_clock)
   end subroutine finish_step

   !> A step that is stable for all contacts that may close, and for ties: 2 / omega, with omega^2 below the greatest
   !> eigenvalue of any body on its springs, twice as stiff where the neighbour moves too [s]
   subroutine critical_step(model, step, status)
      type(block_model), intent(inout) :: model
      real(wp), intent(out) :: step          !! [s]
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: k(:, :), square(:)
      integer :: n, i, side, failed
      type(overlap) :: now
      real(wp) :: stiff_n, stiff_s, length, share, greatest

      step = 0.0_wp
      allocate (k(6, size(model%set%item)), square(size(model%set%item)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      k = 0.0_wp
      do n = 1, merge(0, model%contacts%pairs, model%rigid%setting%used)
         associate (pair => model%contacts%pair(n), a => model%set%item(model%contacts%pair(n)%bodies(1)), &
                    b => model%set%item(model%contacts%pair(n)%bodies(2)))
            call measure_overlap(pair, a, b, now)
            share = merge(1.0_wp, 2.0_wp, a%fixed .or. b%fixed)
            do i = 1, 2
               length = 0.5_wp * max(now%width, 0.25_wp * min(pair%reference_length, pair%incident_length))
               if (pair%point(i)%closed) length = max(length, pair%point(i)%length)
               stiff_n = share * model%law(pair%law)%normal_stiffness * length
               stiff_s = share * model%law(pair%law)%shear_stiffness * length
               do side = 1, 2
                  associate (c => model%set%item(pair%bodies(side)))
                     if (c%fixed) cycle
                     call add_spring(k(:, pair%bodies(side)), c, now%ty(i), -now%tx(i), now%x(i), now%y(i), stiff_n)
                     call add_spring(k(:, pair%bodies(side)), c, now%tx(i), now%ty(i), now%x(i), now%y(i), stiff_s)
                  end associate
               end do
            end do
         end associate
      end do
      ! A body that touches nothing yet will land, on its longest edge at the worst.
      do n = 1, merge(0, size(model%set%parts), model%rigid%setting%used)
         associate (c => model%set%item(model%set%parts(n)%owner))
            if (c%fixed .or. any(k(1:3, model%set%parts(n)%owner) > 0.0_wp)) cycle
            length = maxval(model%set%edges(model%set%parts(n)%first:model%set%parts(n)%last)%length)
            call add_spring(k(:, model%set%parts(n)%owner), c, 0.0_wp, 1.0_wp, c%x + 0.5_wp * length, c%y, &
               2.0_wp * model%law(1)%normal_stiffness * length)
            call add_spring(k(:, model%set%parts(n)%owner), c, 1.0_wp, 0.0_wp, c%x, c%y - c%radius, &
               2.0_wp * model%law(1)%shear_stiffness * length)
         end associate
      end do
      call stiffen_by_ties(model, square)
      greatest = 0.0_wp
      do n = 1, size(model%set%item)
         greatest = max(greatest, square(n) + greatest_eigenvalue(k(:, n)))
      end do
      step = 2.0_wp / sqrt(max(greatest, tiny(1.0_wp)))
   end subroutine critical_step

   !> What the ties add to the squares of the frequencies of the bodies, see add_tie_stiffness
   pure subroutine stiffen_by_ties(model, square)
      type(block_model), intent(inout) :: model
      real(wp), intent(out) :: square(:)     !! (bodies) [1/s^2]
      integer :: k
      square = 0.0_wp
      if (size(model%ties%item) == 0) return
      call place_anchors(model)
      call trace_ties(model%ties)
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            one%answer = 0.0_wp
            one%mobility = 0.0_wp
            if (one%body == 0) cycle
            associate (b => model%set%item(one%body), pull => one%share * model%ties%pull(:, one%point))
               one%answer = sqrt(b%inverse_mass * (pull(1)**2 + pull(2)**2) &
                  + b%inverse_inertia * ((one%at(1) - b%x) * pull(2) - (one%at(2) - b%y) * pull(1))**2)
               one%mobility = b%inverse_mass + b%inverse_inertia * ((one%at(1) - b%x)**2 + (one%at(2) - b%y)**2)
            end associate
         end associate
      end do
      call add_tie_stiffness(model%ties, square)
   end subroutine stiffen_by_ties

   !> Add a spring along (dx, dy) at a point to the mass-scaled 3 x 3 stiffness of a body
   pure subroutine add_spring(k, b, dx, dy, x, y, stiffness)
      real(wp), intent(inout) :: k(6)        !! xx, yy, zz, xy, xz, yz
      type(body), intent(in) :: b
      real(wp), intent(in) :: dx
      real(wp), intent(in) :: dy
      real(wp), intent(in) :: x              !! [m]
      real(wp), intent(in) :: y              !! [m]
      real(wp), intent(in) :: stiffness      !! [N/m]
      real(wp) :: g(3)
      g(1) = dx * sqrt(b%inverse_mass)
      g(2) = dy * sqrt(b%inverse_mass)
      g(3) = ((x - b%x) * dy - (y - b%y) * dx) * sqrt(b%inverse_inertia)
      k = k + stiffness * [g(1)**2, g(2)**2, g(3)**2, g(1) * g(2), g(1) * g(3), g(2) * g(3)]
   end subroutine add_spring

   !> Greatest eigenvalue of a symmetric 3 x 3 matrix, by its trigonometric formula
   pure function greatest_eigenvalue(k) result(value)
      real(wp), intent(in) :: k(6)           !! xx, yy, zz, xy, xz, yz
      real(wp) :: value
      real(wp) :: mean, d(3), spread, determinant
      mean = sum(k(1:3)) / 3.0_wp
      d = k(1:3) - mean
      spread = sqrt((sum(d**2) + 2.0_wp * sum(k(4:6)**2)) / 6.0_wp)
      value = mean
      if (.not. spread > 0.0_wp) return
      determinant = d(1) * (d(2) * d(3) - k(6)**2) - k(4) * (k(4) * d(3) - k(5) * k(6)) &
         + k(5) * (k(4) * k(6) - k(5) * d(2))
      value = mean + 2.0_wp * spread * cos(acos(max(-1.0_wp, min(1.0_wp, 0.5_wp * determinant / spread**3))) / 3.0_wp)
   end function greatest_eigenvalue

end module dem_model
