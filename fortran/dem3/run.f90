!> What a run of blocks in space is made of: the hooks of dem_simulation.
module dem3_run
   use common_kinds, only : wp
   use common_lists, only : stop_end => dem_stop_end, stop_collapse => dem_stop_collapse, stop_left => dem_stop_left
   use common_status, only : status_ok, status_invalid_argument, status_not_finite, status_out_of_memory
   use dem_clock, only : end_step
   use dem_energy, only : energy_terms
   use dem_jointed, only : jointed_model
   use dem_places, only : add_force, count_places
   use dem_simulation, only : model_sizes, simulation, slides_not
   use dem_tape, only : tape, loading
   use dem_ties, only : forget_tie_losses
   use dem3_bodies, only : body, spin_of, turn_freely
   use dem3_law, only : contact_point
   use dem3_patch, only : measure_feature
   use dem3_moreau, only : greatest_speed, number_model_unknowns => number_unknowns, &
      solve_model_contacts => solve_contacts
   use dem3_model, only : advance_model, colour_pairs, critical_step, model_energy => energy_now, move_body, &
      search_pairs, &
      set_distances, set_mortar, solid_model
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: solid_simulation

   type, extends(simulation) :: solid_simulation
      type(solid_model) :: model
      real(wp) :: domain = 0.0_wp               !! displacement by which a body has left the scene [m]; 0: none
   contains
      procedure :: get_model
      procedure :: find_pairs
      procedure :: find_critical_step
      procedure :: advance_springs
      procedure :: number_unknowns
      procedure :: solve_contacts
      procedure :: move_bodies
      procedure :: measure_energy
      procedure :: measure_agitation
      procedure :: measure_speed
      procedure :: measure_unbalance
      procedure :: find_least_balanced
      procedure :: find_fastest
      procedure :: check_limits
      procedure :: mark_rest
      procedure :: stop_bodies
      procedure :: forget_settling
      procedure :: record_state
      procedure :: list_sizes
      procedure :: allocate_state
      procedure :: walk_state
   end type solid_simulation

contains

   function get_model(run) result(model)
      class(solid_simulation), intent(inout), target :: run
      class(jointed_model), pointer :: model
      model => run%model
   end function get_model

   subroutine find_pairs(run, first_time, status)
      class(solid_simulation), intent(inout) :: run
      logical, intent(in) :: first_time
      integer(c_int), intent(out) :: status
      integer :: k
      associate (model => run%model)
         status = status_not_finite
         do k = 1, size(model%set%item)
            if (.not. all(abs(model%set%item(k)%x) <= huge(1.0_wp))) return
         end do
         if (first_time) call set_distances(model)
         call search_pairs(model, status)
         if (status /= status_ok) return
         run%record%pairs = model%pairs
         if (first_time) call set_mortar(model)
         if (any(model%pair(:model%pairs)%lacks_memory)) status = status_out_of_memory
      end associate
   end subroutine find_pairs

   subroutine find_critical_step(run, step, status)
      class(solid_simulation), intent(inout) :: run
      real(wp), intent(out) :: step             !! [s]
      integer(c_int), intent(out) :: status
      call critical_step(run%model, step, status)
   end subroutine find_critical_step

   subroutine advance_springs(run, count, threads, status)
      class(solid_simulation), intent(inout) :: run
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer(c_int), intent(out) :: status
      call advance_model(run%model, count, threads)
      associate (pair => run%model%pair(:run%model%pairs), solver => run%model%rigid)
         status = merge(status_out_of_memory, status_ok, any(pair%lacks_memory))
         solver%open_steps = solver%open_steps + sum(pair%unsolved)
         pair%unsolved = 0
      end associate
   end subroutine advance_springs

   subroutine number_unknowns(run, status)
      class(solid_simulation), intent(inout) :: run
      integer(c_int), intent(out) :: status
      call number_model_unknowns(run%model, status)
   end subroutine number_unknowns

   subroutine solve_contacts(run, status)
      class(solid_simulation), intent(inout) :: run
      integer(c_int), intent(out) :: status
      call solve_model_contacts(run%model, status)
   end subroutine solve_contacts

   subroutine move_bodies(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         call move_body(run%model, run%model%set%item(k), run%model%stale)
      end do
      call end_step(run%model%model_clock)
   end subroutine move_bodies

   function measure_energy(run) result(now)
      class(solid_simulation), intent(in) :: run
      type(energy_terms) :: now
      now = model_energy(run%model)
   end function measure_energy

   !> Kinetic energy at the last forces [J]
   function measure_agitation(run) result(energy)
      class(solid_simulation), intent(in) :: run
      real(wp) :: energy
      type(energy_terms) :: now
      now = model_energy(run%model)
      energy = now%kinetic
   end function measure_agitation

   !> Greatest speed of a body [m/s]
   function measure_speed(run) result(speed)
      class(solid_simulation), intent(in) :: run
      real(wp) :: speed
      speed = greatest_speed(run%model)
   end function measure_speed

   !> Greatest unbalanced force over weight, and moment over weight times radius
   function measure_unbalance(run) result(ratio)
      class(solid_simulation), intent(in) :: run
      real(wp) :: ratio
      real(wp) :: g
      integer :: k
      associate (model => run%model)
         g = max(norm2(model%gravity), 1.0e-3_wp)
         ratio = 0.0_wp
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               ratio = max(ratio, norm2(b%force / b%mass + model%gravity) / g, &
                  norm2(b%moment) / (b%mass * g * b%radius))
            end associate
         end do
      end associate
   end function measure_unbalance

   function find_least_balanced(run) result(number)
      class(solid_simulation), intent(in) :: run
      integer :: number
      real(wp) :: greatest, rate
      integer :: k
      number = 0
      greatest = 0.0_wp
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            if (b%fixed) cycle
            rate = norm2(b%force * b%inverse_mass + run%model%gravity)
            if (rate > greatest .or. number == 0) number = k
            greatest = max(greatest, rate)
         end associate
      end do
   end function find_least_balanced

   function find_fastest(run) result(number)
      class(solid_simulation), intent(in) :: run
      integer :: number
      real(wp) :: greatest, speed
      integer :: k
      number = 0
      greatest = 0.0_wp
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            if (b%fixed) cycle
            speed = norm2(b%v)
            if (speed > greatest .or. number == 0) number = k
            greatest = max(greatest, speed)
         end associate
      end do
   end function find_fastest

   !> Has a body moved farther than what counts as collapse, or, once it is shaken, left the scene?
   subroutine check_limits(run, collapse)
      class(solid_simulation), intent(inout) :: run
      real(wp), intent(in) :: collapse
      integer :: k
      real(wp) :: away, turned
      logical :: gone
      associate (model => run%model, record => run%record)
         do k = 1, size(model%set%item)
            if (model%set%item(k)%fixed) cycle
            associate (b => model%set%item(k))
               away = norm2(b%x - b%rest)
               ! The trace of a rotation is 1 + 2 cos of its angle.
               turned = acos(max(-1.0_wp, min(1.0_wp, 0.5_wp * (sum(b%turn * b%rest_turn) - 1.0_wp))))
               gone = collapse > 0.0_wp .and. away > collapse
               if (gone .and. model%shaking) gone = slides_not(run%options, turned, b%rest(3) - b%x(3))
               if (gone) record%reason = stop_collapse
            end associate
            if (model%shaking .and. run%domain > 0.0_wp .and. away > run%domain) record%reason = stop_left
            if (record%reason == stop_end) cycle
            record%blamed(1) = k
            return
         end do
      end associate
   end subroutine check_limits

   subroutine mark_rest(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            b%rest = b%x
            b%rest_turn = b%turn
         end associate
      end do
   end subroutine mark_rest

   subroutine stop_bodies(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         run%model%set%item(k)%v = 0.0_wp
         run%model%set%item(k)%swing = 0.0_wp
      end do
   end subroutine stop_bodies

   subroutine forget_settling(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k, n
      associate (model => run%model)
         do k = 1, model%pairs
            associate (pair => model%pair(k))
               pair%friction_loss = 0.0_wp
               pair%damping_loss = 0.0_wp
               pair%support_work = 0.0_wp
               do n = 1, pair%points
                  pair%point(n)%dash_n = 0.0_wp
                  pair%point(n)%dash_s = 0.0_wp
                  pair%point(n)%force = pair%point(n)%force - pair%point(n)%dash
                  pair%point(n)%dash = 0.0_wp
               end do
            end associate
         end do
         model%dowels%friction_loss = 0.0_wp
         model%dowels%damping_loss = 0.0_wp
         model%dowels%support_work = 0.0_wp
         do k = 1, size(model%dowels)
            model%dowels(k)%dash = 0.0_wp
         end do
         call forget_tie_losses(model%ties)
         model%lost = 0.0_wp
         model%joint_loss = 0.0_wp
         model%support_work = 0.0_wp
         model%set%item%work = 0.0_wp
         model%set%item%bounces = 0
         model%set%item%airborne = 0.0_wp
      end associate
   end subroutine forget_settling

   subroutine record_state(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      real(wp) :: half
      type(body) :: b
      associate (model => run%model, record => run%record, n => run%record%points)
         half = 0.5_wp * model%drift
         do k = 1, size(model%set%item)
            b = model%set%item(k)
            if (.not. b%fixed) call turn_freely(b, -model%drift)
            record%place(:, k, n) = b%x - model%drift * b%v
            record%turn(:, :, k, n) = b%turn
            record%rate(:, k, n) = 0.0_wp
            if (b%fixed) cycle
            record%rate(1:3, k, n) = b%v - half * (b%force / b%mass + model%pull)
            record%rate(4:6, k, n) = spin_of(b, b%swing - half * b%moment)
         end do
      end associate
      call record_joints(run%model, run%record%joint(:, :, run%record%points))
      if (count_places(run%model%places) > 0) call record_places(run%model, run%record%press(:, :, run%record%points))
   end subroutine record_state

   !> Forces of the joints at the last evaluation, and their energy losses up to then
   pure subroutine record_joints(model, joint)
      type(solid_model), intent(in) :: model
      real(wp), intent(out) :: joint(:, :)          !! (5, joints) on the first body [N]; friction, dashpots [J]
      real(wp) :: force(3)
      integer :: k, n
      joint(1:3, :) = 0.0_wp
      joint(4:5, :) = model%joint_loss
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            if (pair%joint == 0) cycle
            force = 0.0_wp
            do n = 1, pair%points
               force = force + pair%point(n)%force
            end do
            ! The forces of points are those on the second part.
            if (model%set%parts(pair%part(1))%owner < model%set%parts(pair%part(2))%owner) force = -force
            joint(:, pair%joint) = joint(:, pair%joint) + [force, pair%friction_loss, pair%damping_loss]
         end associate
      end do
   end subroutine record_joints

   !> Forces of the contacts as drawn at the last evaluation, and their places
   pure subroutine record_places(model, press)
      type(solid_model), intent(in) :: model
      real(wp), intent(out) :: press(:, :)          !! see dem_places
      real(wp) :: normal(3), gap, at(3)
      integer :: k, n, who(2)
      press = 0.0_wp
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            if (pair%joint == 0) cycle
            who = model%set%parts(pair%part)%owner
            associate (low => model%set%item(minval(who)))
               do n = 1, pair%points
                  associate (point => pair%point(n))
                     if (.not. any(abs(point%force) > 0.0_wp)) cycle
                     call measure_feature(point%what, model%set%item(who(1)), model%set%item(who(2)), normal, gap, at)
                     at = at - low%x
                     ! The forces of points are those on the second body.
                     call add_force(model%places, pair%joint, matmul(at, low%turn), matmul(normal, low%turn), &
                        merge(-point%force, point%force, who(1) < who(2)), &
                        dot_product(point%force - point%dash, normal), press)
                  end associate
               end do
            end associate
         end associate
      end do
   end subroutine record_places

   function list_sizes(run) result(told)
      class(solid_simulation), intent(in) :: run
      integer(c_int64_t) :: told(model_sizes)
      type(body) :: one
      type(contact_point) :: point
      told = int([storage_size(one), storage_size(point), size(run%model%set%item), size(run%model%set%parts), &
         run%model%pairs, size(run%model%dowels), 0, 0], c_int64_t)
   end function list_sizes

   subroutine allocate_state(run, sizes, most, status)
      class(solid_simulation), intent(inout) :: run
      integer(c_int64_t), intent(in) :: sizes(model_sizes)
      integer(c_int64_t), intent(in) :: most
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_invalid_argument
      if (sizes(5) < 0 .or. sizes(5) > most .or. sizes(6) /= size(run%model%dowels)) return
      allocate (run%model%pair(sizes(5)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) run%model%pairs = int(sizes(5))
   end subroutine allocate_state

   subroutine walk_state(run, on, status)
      class(solid_simulation), intent(inout), target :: run
      type(tape), intent(inout) :: on
      integer(c_int), intent(out) :: status
      integer :: k, failed
      status = status_ok
      associate (model => run%model)
         call on%pass(model%set%item, storage_size(model%set%item))
         call on%pass(model%pull, storage_size(model%pull))
         call on%pass(model%pull_before, storage_size(model%pull_before))
         call on%pass(model%skin, storage_size(model%skin))
         call on%pass(model%reach, storage_size(model%reach))
         call on%pass(model%margin, storage_size(model%margin))
         call on%pass(model%far, storage_size(model%far))
         call on%pass(model%wander, storage_size(model%wander))
         call on%pass(model%lost, storage_size(model%lost))
         call on%pass(model%joint_loss, storage_size(model%joint_loss))
         call on%pass(model%support_work, storage_size(model%support_work))
         call on%pass(model%dowels, storage_size(model%dowels))
         do k = 1, model%pairs
            associate (pair => model%pair(k))
               call on%pass(pair%part, storage_size(pair%part))
               call on%pass(pair%law, storage_size(pair%law))
               call on%pass(pair%joint, storage_size(pair%joint))
               call on%pass(pair%points, storage_size(pair%points))
               call on%pass(pair%reference, storage_size(pair%reference))
               call on%pass(pair%marks, storage_size(pair%marks))
               call on%pass(pair%place, storage_size(pair%place))
               call on%pass(pair%turn, storage_size(pair%turn))
               call on%pass(pair%friction_loss, storage_size(pair%friction_loss))
               call on%pass(pair%damping_loss, storage_size(pair%damping_loss))
               call on%pass(pair%support_work, storage_size(pair%support_work))
               call on%pass(pair%crushed, storage_size(pair%crushed))
               if (on%mode == loading) then
                  status = status_invalid_argument
                  if (on%short .or. pair%points < 0 .or. pair%points > size(on%bytes)) return
                  allocate (pair%point(pair%points), stat=failed)
                  status = merge(status_ok, status_out_of_memory, failed == 0)
                  if (failed /= 0) return
               end if
               if (allocated(pair%point)) call on%pass(pair%point, storage_size(pair%point))
            end associate
         end do
         if (on%mode == loading .and. .not. on%short) call colour_pairs(model, status)
      end associate
   end subroutine walk_state

end module dem3_run
